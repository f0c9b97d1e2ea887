// SPDX-License-Identifier: BSD-3-Clause
// Patches of skin from the names that cells report: who is joined to whom by which port.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "skinctl/skin_network/network_root.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Cells in one piece, and the connectors between them.
struct PatchGraph {
  struct Joint {
    std::size_t a = 0, b = 0;             ///< joined cells, as indices in `ids`
    std::uint8_t port_a = 0, port_b = 0;  ///< ports of both cells, 0 to 3
    friend bool operator==(const Joint&, const Joint&) = default;
  };
  std::vector<std::uint16_t> ids;  ///< ids of the cells: the root first, then by distance from it
  std::vector<Joint>
      joints;  ///< connectors, each once; the first `ids.size() - 1` reach all cells from the root, by `ids`
};

struct SkinGraph {
  std::vector<PatchGraph> patches;      ///< patches of the skin, the largest first
  std::vector<std::string> complaints;  ///< contradictions in the reports, and their consequences
};

/// The patches of a skin from the reports of its cells. Cells whose id several cells have, or which is none,
/// are left out; so is a connector on which its two cells do not agree. Whatever the reports say, the graph
/// is consistent: each port is used once, and by both of its cells.
[[nodiscard]] inline SkinGraph skin_graph(const std::vector<CellNames>& reports) {
  SkinGraph out;
  std::map<unsigned, std::vector<std::size_t>> by_id;
  for (std::size_t i = 0; i < reports.size(); ++i) by_id[reports[i].id].push_back(i);
  std::map<unsigned, const CellNames*> cells;
  for (const auto& [id, who] : by_id) {
    const std::string name = "id " + std::to_string(id);
    if (id == 0 || id > CellNet::highest_id)
      out.complaints.push_back(std::to_string(who.size()) + " cells have " + name +
                               ", which is none: left out");
    else if (who.size() > 1)
      out.complaints.push_back(std::to_string(who.size()) + " cells say that they have " + name +
                               ": all of them are left out");
    else
      cells[id] = &reports[who.front()];
  }
  const auto agreed = [&](unsigned id, std::uint8_t port) -> const CellNames* {
    const auto n = cells.at(id)->neighbours[port];
    const auto other = cells.find(n.id);
    if (n.id == 0 || n.id == id || other == cells.end() || n.port >= CellNet::ports) return nullptr;
    const auto back = other->second->neighbours[n.port];
    return back.id == id && back.port == port ? other->second : nullptr;
  };
  for (const auto& [id, names] : cells)
    for (std::uint8_t p = 0; p < CellNet::ports; ++p)
      if (names->neighbours[p].id != 0 && agreed(id, p) == nullptr)
        out.complaints.push_back("cell " + std::to_string(id) + " names cell " +
                                 std::to_string(names->neighbours[p].id) + " at port " +
                                 std::to_string(p + 1) + ", which does not say so: no connector");
  std::map<unsigned, std::size_t> index;
  for (const auto& [root, unused] : cells) {
    if (index.count(root) != 0) continue;
    PatchGraph patch;
    std::vector<PatchGraph::Joint> loops;
    patch.ids.push_back(std::uint16_t(root));
    index[root] = 0;
    for (std::size_t i = 0; i < patch.ids.size(); ++i)
      for (std::uint8_t p = 0; p < CellNet::ports; ++p) {
        const unsigned id = patch.ids[i];
        const CellNames* other = agreed(id, p);
        if (other == nullptr) continue;
        const auto [at, fresh] = index.try_emplace(other->id, patch.ids.size());
        const PatchGraph::Joint joint{i, at->second, p, cells.at(id)->neighbours[p].port};
        if (fresh) {
          patch.ids.push_back(other->id);
          patch.joints.push_back(joint);
        } else if (at->second > i || (at->second == i && joint.port_b > p)) {
          const bool tree = std::find(patch.joints.begin(), patch.joints.end(), joint) != patch.joints.end();
          if (!tree) loops.push_back(joint);
        }
      }
    patch.joints.insert(patch.joints.end(), loops.begin(), loops.end());
    out.patches.push_back(std::move(patch));
  }
  std::stable_sort(out.patches.begin(), out.patches.end(),
                   [](const auto& a, const auto& b) { return a.ids.size() > b.ids.size(); });
  return out;
}

SKINCTL_END_NAMESPACE
