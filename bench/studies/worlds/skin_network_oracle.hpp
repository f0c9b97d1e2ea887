// What a skin's network must have found, by a search that sees all of it at once; and the token that it is
// measured against.
#pragma once

#include <map>
#include <set>
#include <string>

#include "examples/worlds/skin_network.hpp"

namespace skinctl::testing {

/// Cells that the PC reaches, by their distance in links; 0: not reached.
[[nodiscard]] inline std::vector<unsigned> distances(const SkinTopology& t) {
  std::vector<unsigned> d(t.ports.size(), 0);
  std::vector<std::size_t> front = {0}, next;
  for (unsigned depth = 1; !front.empty(); ++depth, front.swap(next)) {
    next.clear();
    for (const std::size_t n : front)
      for (const auto& e : t.ports[n])
        if (e.joined && e.node != 0 && d[e.node] == 0) d[e.node] = depth, next.push_back(e.node);
  }
  return d;
}

/// What is wrong with the network; empty if nothing is: ids unique, labels 1 to n, names of all neighbours
/// right, every label reached from the PC in as many hops as its cell counted.
///
/// @param reports  whether they must be there.
[[nodiscard]] inline std::string network_error(const SkinNetwork& net, bool reports = true) {
  const auto& t = net.topology();
  const auto d = distances(t);
  std::map<unsigned, std::size_t> by_id, by_label;
  std::size_t reached = 0;
  const auto at = [](std::size_t node) { return "cell " + std::to_string(node); };
  for (std::size_t n = 1; n < t.ports.size(); ++n) {
    if (d[n] == 0) continue;
    ++reached;
    const CellMemory& m = net.cell(n);
    if (m.epoch != net.root().epoch()) return at(n) + " is in another epoch";
    if (m.id == 0 || m.id > CellNet::highest_id) return at(n) + " has no id";
    if (!by_id.emplace(m.id, n).second) return at(n) + " has the id of " + at(by_id[m.id]);
    if (!by_label.emplace(m.label, n).second) return at(n) + " has the label of " + at(by_label[m.label]);
    if (m.hops < d[n]) return at(n) + " counts fewer hops than there are";
  }
  if (reached != net.root().cells()) return "the PC counts " + std::to_string(net.root().cells()) + " cells";
  if (reached > 0 && (by_label.begin()->first != 1 || by_label.rbegin()->first != reached))
    return "labels are not 1 to " + std::to_string(reached);
  std::set<unsigned> reported;
  for (const CellNames& names : net.root().reports()) {
    if (!reports) break;
    if (by_id.count(names.id) == 0) return "id " + std::to_string(names.id) + " is nobody's";
    const std::size_t n = by_id[names.id];
    if (!reported.insert(names.id).second) return at(n) + " reported twice";
    if (net.cell(n).label != names.label) return at(n) + " reported another label";
    for (std::size_t p = 0; p < 4; ++p) {
      const auto& e = t.ports[n][p];
      const unsigned id = e.joined && e.node > 0 ? net.cell(e.node).id : 0;
      if (names.neighbours[p].id != id || (id != 0 && names.neighbours[p].port != e.port))
        return at(n) + " reported a wrong neighbour at port " + std::to_string(p);
    }
  }
  if (reports && reported.size() != reached) return std::to_string(reported.size()) + " cells have reported";
  for (const auto& [label, n] : by_label) {
    const std::size_t box = net.root().route(std::uint16_t(label));
    if (box >= t.ports[0].size()) return "no way to label " + std::to_string(label);
    std::size_t here = t.ports[0][box].node;
    unsigned hops = 1;
    for (; here != n; ++hops) {
      const auto port = route(net.cell(here), std::uint16_t(label));
      if (port >= 4 || hops > reached || !t.ports[here][port].joined) return "the way to " + at(n) + " ends";
      here = t.ports[here][port].node;
    }
    if (hops != net.cell(n).hops) return "the way to " + at(n) + " is longer than it counts";
  }
  return {};
}

/// Baseline: a token that walks the skin depth first, along each link there and back. [s]
[[nodiscard]] inline double token_seconds(const SkinTopology& t, double loss, double hop, Random& rng) {
  std::vector<bool> seen(t.ports.size(), false);
  std::vector<std::pair<std::size_t, std::size_t>> stack = {{0, 0}};
  seen[0] = true;
  double time = 0;
  const auto carry = [&] {
    time += hop;
    while (double(rng() >> 11) * 0x1p-53 < loss) time += 1.25 * hop;
  };
  while (!stack.empty()) {
    auto& [node, port] = stack.back();
    if (port == t.ports[node].size()) {
      stack.pop_back();
      if (!stack.empty()) carry();
      continue;
    }
    const auto e = t.ports[node][port++];
    if (!e.joined) continue;
    carry();
    if (seen[e.node]) {
      carry();  // it has been there, and goes back
    } else {
      seen[e.node] = true;
      stack.emplace_back(e.node, 0);
    }
  }
  return time;
}

}  // namespace skinctl::testing
