// SPDX-License-Identifier: BSD-3-Clause
// Skin files on robots: cells in the frames of a model's links. Needs no parser.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "skinctl/io/skin_contents.hpp"
#include "skinctl/io/urdf_tree.hpp"
#include "skinctl/model/named_links.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/region.hpp"
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
/// The patches of a file on a description with links by name: from `urdf_to_model`, or `ur5::Ros2Links`.
/// Throws `ConfigurationError` as for a URDF.
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

/// The placed patches for a `SkinOf`: each cell with its patch's gains times its own `gain` and the weights
/// of the regions that have it, and with its threshold, below which its force readings are 0. Masked cells
/// neither push nor count as usable; a `TrustedSkin` fills them in.
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
      const double factor = cell.gain * (region == weights.end() ? 1 : region->second);
      made.masked = !cell.masked.empty();
      if (factor != 1) made.gains = {patch.gains.force * factor, patch.gains.proximity * factor};
      if (cell.threshold) made.gate[0] = EventGate<>::dead_band(*cell.threshold);
      to.cells.push_back(made);
    }
  }
  return out;
}

/// The neighbours of each cell, by index in the order of `skin_patches`: those that the file names at its
/// ports, on the same link; in patches for which it names none, those of `CellGraph(places)`.
[[nodiscard]] SKINCTL_COLD inline CellGraph cell_graph(const SkinFile& file,
                                                       const std::vector<PlacedSkinPatch>& placed) {
  std::vector<CellPlace> places;
  std::vector<const SkinFile::Cell*> cells;
  std::unordered_map<std::uint32_t, CellGraph::Index> index;
  for (const PlacedSkinPatch& on : placed)
    for (std::size_t c = 0; c < on.cells.size(); ++c) {
      const auto& X_LC = on.cells[c].X_LC;
      index[on.cells[c].id] = static_cast<CellGraph::Index>(cells.size());
      cells.push_back(&file.patches[on.patch].cells[c]);
      places.push_back(
          {on.link, static_cast<std::size_t>(&on - placed.data()), X_LC.origin(), X_LC.axis_z()});
    }
  const CellGraph near(places);
  std::vector<std::vector<CellGraph::Index>> lists(cells.size());
  const auto named = [&](std::size_t i) { return !cells[i]->neighbours.empty(); };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const CellGraph::Index j : near.neighbours(i))
      if (!named(i) || !named(j)) lists[i].push_back(j);
    for (const std::uint32_t id : cells[i]->neighbours)
      if (id != SkinFile::nobody && places[index.at(id)].link == places[i].link)
        lists[i].push_back(index.at(id));
  }
  return CellGraph(std::move(lists));
}

/// The file's regions for a `ContactSkin`, which stops a robot when one is pressed harder than its
/// `force_limit`. The weight is in the gains of `skin_patches`; it is taken off again, for the limit to be of
/// newtons. Where regions overlap, a cell keeps the other's weight. Throws `ConfigurationError` for a limit
/// of a region of weight 0, and for more than 32 regions.
[[nodiscard]] SKINCTL_COLD inline Regions regions_of(const SkinFile& file) {
  std::vector<Region> out;
  for (const SkinFile::Region& r : file.regions)
    if (r.weight > 0) {
      out.push_back({r.name, r.cells, 1 / r.weight, r.force_limit});
    } else {
      require(!(r.force_limit < std::numeric_limits<double>::infinity()),
              ("region " + detail::skin_quoted(r.name) + " of weight 0, which feels nothing: force_limit")
                  .c_str(),
              r.force_limit, "none");
    }
  return Regions(std::move(out));
}

/// The error of a cell's pose, one standard deviation in the worst direction: an upper bound from the file's
/// covariances of its patch and its own pose. What is not given counts as exact.
struct PlaceDeviation {
  double place = 0;      ///< deviation of the cell's origin [m]
  double direction = 0;  ///< deviation of the cell's normal [rad]
};
[[nodiscard]] SKINCTL_COLD inline PlaceDeviation place_deviation(const SkinFile::Patch& patch,
                                                                 const SkinFile::Cell& cell) {
  const auto most = [](const std::vector<double>& C, std::size_t from) {
    if (C.size() != 21) return 0.0;
    const auto at = [&](std::size_t i, std::size_t j) { return C[i * 6 - i * (i + 1) / 2 + j]; };
    Eigen::Matrix3d block;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i; j < 3; ++j)
        block(static_cast<int>(i), static_cast<int>(j)) = block(static_cast<int>(j), static_cast<int>(i)) =
            at(from + i, from + j);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(block, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
  };
  const double lever = std::sqrt(dot(cell.X_RootCell.p, cell.X_RootCell.p));
  return {std::hypot(most(patch.covariance, 0) + lever * most(patch.covariance, 3), most(cell.covariance, 0)),
          std::hypot(most(patch.covariance, 3), most(cell.covariance, 3))};
}

SKINCTL_END_NAMESPACE
