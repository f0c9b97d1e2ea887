#include "examples/compliant_ur5/skin.hpp"

#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/skin_placement.hpp"
#include "skinctl/model/ur5_links.hpp"

namespace compliant_ur5 {
namespace {

using namespace skinctl;

template <std::size_t... I>
SkinPatches patches_of(const SkinFile& file, std::index_sequence<I...>) {
  const auto placed = place_skin<ur5::Ros2Links>(file);
  const auto on = [&](std::size_t link) -> const PlacedSkinPatch& {
    const PlacedSkinPatch* found = nullptr;
    for (const PlacedSkinPatch& p : placed) {
      if (p.link != link) continue;
      if (found != nullptr)
        refuse("skinctl: " + file.source + ": two patches on link " + std::to_string(link));
      found = &p;
    }
    if (found == nullptr) refuse("skinctl: " + file.source + ": no patch on link " + std::to_string(link));
    return *found;
  };
  return SkinPatches(patch_of<I, ur5::skin_cells<cells>[I]>(file, on(I))...);
}

template <class F>
void each_cell(const SkinPatches& patches, const F& f) {
  const auto one = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& patch) {
    for (const auto& cell : patch.any()) f(I, cell);
  };
  std::apply([&](const auto&... patch) { (one(patch), ...); }, patches);
}

}  // namespace

SkinPatches skin_patches(const Settings& s) {
  std::array<CellGains, 6> gains{};
  for (std::size_t i = 0; i < 6; ++i)
    gains[i] = s.rigid ? CellGains{.force = 0, .proximity = 0}
                       : CellGains{.force = s.control.force_gain[i], .proximity = s.control.proximity_gain};
  if (s.skin.empty()) return ur5::skin_patches<cells>(gains);
  SkinFile file = read_skin_file(s.skin);
  if (s.rigid)
    for (auto& patch : file.patches) patch.gains = {.force = 0, .proximity = 0};
  return patches_of(file, std::make_index_sequence<6>{});
}

std::vector<ObservedCell> observed_cells(const SkinPatches& patches) {
  std::vector<ObservedCell> out;
  each_cell(patches, [&](std::size_t link, const auto& c) {
    out.push_back({c.id, static_cast<int>(link), c.X_LC.origin(), c.X_LC.axis_z()});
  });
  return out;
}

std::vector<simulated_ur5::SkinCell> simulated_cells(const SkinPatches& patches) {
  std::vector<simulated_ur5::SkinCell> out;
  for (const ObservedCell& c : observed_cells(patches)) {
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
