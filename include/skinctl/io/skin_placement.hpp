// Skin files on robots: cells in the frames of a model's links. Needs no parser.
#pragma once

#include <unordered_map>

#include "skinctl/io/skin_contents.hpp"
#include "skinctl/io/urdf_tree.hpp"
#include "skinctl/model/named_links.hpp"
#include "skinctl/tactile/skin_of.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A patch of a file, its cells in the frame of the model's link that carries it.
struct PlacedSkinPatch {
  std::size_t link = 0;                ///< index of the model's link
  std::size_t patch = 0;               ///< index in `SkinFile::patches`
  std::vector<detail::AnyCell> cells;  ///< `X_LC` in `Link<link>`, in the order of the file
};

namespace detail {
template <class Find>
[[nodiscard]] SKINCTL_COLD std::vector<PlacedSkinPatch> place_skin(const SkinFile& file, const Find& find) {
  file.check();
  std::vector<PlacedSkinPatch> placed;
  for (std::size_t k = 0; k < file.patches.size(); ++k) {
    const SkinFile::Patch& patch = file.patches[k];
    const auto fail = [&](const std::string& what) {
      refuse("skinctl: " + file.source + (patch.line > 0 ? ":" + std::to_string(patch.line) : "") +
             ": patch " + skin_quoted(patch.name) + ", link " + skin_quoted(patch.link) + ": " + what);
    };
    const UrdfFrame frame = find(patch.link, fail);
    if (frame.joint < 0) fail("no joint moves it");
    for (const SkinFile::Link& link : file.links) {
      if (link.name != patch.link || dot(link.joint_axis, link.joint_axis) == 0) continue;
      const Xyz<double> z = frame.R.transpose().z, off = z - link.joint_axis;
      if (!(dot(off, off) <= 1e-6))
        fail("the joint's axis is (" + skin_number(z.x) + ", " + skin_number(z.y) + ", " + skin_number(z.z) +
             ") in the robot's frame of that name and (" + skin_number(link.joint_axis.x) + ", " +
             skin_number(link.joint_axis.y) + ", " + skin_number(link.joint_axis.z) +
             ") in the file's: another description of the robot");
    }
    const Rotation<double> R = frame.R * patch.X_LinkRoot.rotation();
    const Xyz<double> p = frame.p + frame.R * patch.X_LinkRoot.p;
    PlacedSkinPatch out{static_cast<std::size_t>(frame.joint), k, {}};
    for (const SkinFile::Cell& cell : patch.cells)
      out.cells.push_back({cell.id, Transform<AnyLink, Cell>(normalised(R * cell.X_RootCell.rotation()),
                                                             p + R * cell.X_RootCell.p)});
    placed.push_back(std::move(out));
  }
  return placed;
}
}  // namespace detail

/// The patches of a file on the robot of a URDF, link by link of the same name: for `calibrated_from(urdf)`.
/// Throws `ConfigurationError` with the patch for a link that the URDF does not have or that no joint moves,
/// for one whose joint has another axis than the file says, and where `SkinFile::check` does.
[[nodiscard]] inline std::vector<PlacedSkinPatch> place_skin(const SkinFile& file, const Urdf& urdf) {
  return detail::place_skin(file, [&](const std::string& link, const auto& fail) {
    for (const UrdfFrame& f : urdf.frames)
      if (f.name == link) return f;
    fail(urdf.source + " has no such link; there are " +
         detail::listed(urdf.frames, [](const UrdfFrame& f) { return f.name; }));
    return UrdfFrame{};
  });
}
/// The same on a description with links by name: from `urdf_to_model`, or `ur5::Ros2Links`.
template <NamesLinks D>
[[nodiscard]] std::vector<PlacedSkinPatch> place_skin(const SkinFile& file) {
  return detail::place_skin(file, [&](const std::string& link, const auto& fail) {
    for (const NamedLink& f : D::named_links)
      if (f.name == link) return UrdfFrame{f.name, f.link, f.R, f.p};
    fail("the robot has no such link; there are " +
         detail::listed(D::named_links, [](const NamedLink& f) { return f.name; }));
    return UrdfFrame{};
  });
}

/// The placed patches for a `SkinOf`: each cell with its patch's gains times its own `gain` and the weights of
/// the regions that have it, and with its threshold, below which its force readings are 0. Masked cells get
/// gains of 0: they are heard and do not push.
[[nodiscard]] SKINCTL_COLD inline std::vector<SkinPatch> skin_patches(
    const SkinFile& file, const std::vector<PlacedSkinPatch>& placed) {
  std::unordered_map<std::uint32_t, double> weights;
  for (const SkinFile::Region& region : file.regions)
    for (const std::uint32_t id : region.cells) weights.try_emplace(id, 1).first->second *= region.weight;
  std::vector<SkinPatch> out;
  for (const PlacedSkinPatch& on : placed) {
    const SkinFile::Patch& patch = file.patches[on.patch];
    SkinPatch& to = out.emplace_back(SkinPatch{on.link, patch.gains, {}});
    for (std::size_t c = 0; c < patch.cells.size(); ++c) {
      const SkinFile::Cell& cell = patch.cells[c];
      SkinCell made{.id = cell.id, .X_LC = on.cells[c].X_LC};
      const auto region = weights.find(cell.id);
      const double factor =
          cell.masked.empty() ? cell.gain * (region == weights.end() ? 1 : region->second) : 0;
      if (factor != 1) made.gains = {patch.gains.force * factor, patch.gains.proximity * factor};
      if (cell.threshold) made.force = EventGate<>::dead_band(*cell.threshold);
      to.cells.push_back(made);
    }
  }
  return out;
}

SKINCTL_END_NAMESPACE
