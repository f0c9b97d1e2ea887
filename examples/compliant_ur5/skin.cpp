#include "examples/compliant_ur5/skin.hpp"

#include "skinctl/core/contract.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace compliant_ur5 {

using namespace skinctl;

double proximity_gain(const Settings& s, std::size_t link) {
  if (!s.keep_clear) return 0;
  constexpr double steepest = 0.6495;   // 3 sqrt(3) / 8: slope of 1 / (1 + x^2) where it falls fastest
  constexpr double cells_that_see = 4;  // the same thing at once, close to it
  const double most = s.control.stiffest_wall * s.clear.proximity_distance /
                      (s.newtons_per_reading * steepest * cells_that_see);
  require(s.clear.proximity_share >= 0 && s.clear.proximity_share <= most, "clear.proximity_share",
          s.clear.proximity_share, ("0 to " + std::to_string(most)).c_str());
  return s.clear.proximity_share * s.control.force_gain[link];
}

std::vector<SkinPatch> skin_patches(const Settings& s, double heavier) {
  std::vector<SkinPatch> out;
  if (!s.skin.empty()) {
    out = patches_of_file(s);
  } else {
    const auto add = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& patch) {
      SkinPatch& to = out.emplace_back(
          SkinPatch{I, {.force = s.control.force_gain[I], .proximity = proximity_gain(s, I)}, {}});
      for (const auto& cell : patch.any()) to.cells.push_back({.id = cell.id, .X_LC = cell.X_LC});
    };
    std::apply([&](const auto&... patch) { (add(patch), ...); }, ur5::skin_patches<cells>());
  }
  if (s.hand && s.hand->palm_gain > 0) {
    const auto& a = s.hand->palm_axes;
    SkinCell cell{.id = palm_cell,
                  .X_LC = {Rotation<double>{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}, {a[6], a[7], a[8]}},
                           {s.hand->palm[0], s.hand->palm[1], s.hand->palm[2]}}};
    out.push_back({5, {.force = s.hand->palm_gain, .proximity = 0}, {cell}});
  }
  const double share = s.rigid ? 0 : 1 / heavier;
  const auto scale = [&](auto& gains) { gains.force *= share, gains.proximity *= share; };
  for (SkinPatch& patch : out) {
    scale(patch.gains);
    for (SkinCell& cell : patch.cells)
      if (cell.gains) scale(*cell.gains);
  }
  return out;
}

CellGraph skin_graph(const Settings& s, const std::vector<SkinPatch>& patches) {
  if (s.skin.empty()) return CellGraph(UrSkin(patches).places());
  return graph_of_file(s);
}

std::vector<ObservedCell> observed_cells(const std::vector<SkinPatch>& patches) {
  std::vector<ObservedCell> out;
  for (const SkinPatch& patch : patches)
    for (const SkinCell& c : patch.cells)
      out.push_back({c.id, static_cast<int>(patch.link), c.X_LC.origin(), c.X_LC.axis_z()});
  return out;
}

std::vector<simulated_ur5::SkinCell> simulated_cells(const std::vector<SkinPatch>& patches) {
  std::vector<simulated_ur5::SkinCell> out;
  for (const ObservedCell& c : observed_cells(patches)) {
    if (c.id == palm_cell) continue;  // the hand's, which has its own simulation
    simulated_ur5::SkinCell cell;
    cell.id = c.id;
    cell.link = static_cast<std::size_t>(c.link);
    cell.position = {c.position.x, c.position.y, c.position.z};
    cell.normal = {c.normal.x, c.normal.y, c.normal.z};
    simulated_ur5::complete(cell);
    out.push_back(cell);
  }
  return out;
}

}  // namespace compliant_ur5
