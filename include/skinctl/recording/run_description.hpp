// SPDX-License-Identifier: BSD-3-Clause
// What a viewer has to know of a run: names, robot, skin, and where the links are.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "skinctl/io/skin_cloud.hpp"
#include "skinctl/io/urdf_tree.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/model/named_links.hpp"
#include "skinctl/tactile/cell_place.hpp"
#include "skinctl/tactile/skin_of.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Axes and origin of a link in the base.
struct LinkPlace {
  Rotation<double> R;
  Xyz<double> p{0, 0, 0};
};

/// A frame of `/tf`: a named link, where it is in the model's link that carries it.
struct RunFrame {
  std::string name;
  std::size_t link = 0;  ///< index into the places that `RunDescription::places` fills
  LinkPlace in_link{};
};

/// The cells of `/skin/contacts`, in any order.
struct PressedCells {
  std::vector<CellPlace> places{};   ///< a cell's link is an index into the places of a run
  std::vector<std::uint32_t> ids{};  ///< id of each cell, in the order of `places`
  double threshold = 0.5;            ///< force above the cell's lowest so far from which it is pressed [N]
};

/// A run in words and places, the same for a file, a stream and DDS. Only the joints are needed.
struct RunDescription {
  std::vector<std::string> joints{};  ///< names of the joints, one for each
  std::vector<std::string> laws{};    ///< names of the laws, one for each torque; missing ones are numbered
  std::string urdf{};                 ///< text of `/robot_description`; empty: none is sent
  std::string layout{};               ///< `/skin/layout`, a skin file in JSON; empty: none is sent
  std::string base = "base_link";
  std::vector<RunFrame> frames{};  ///< frames of `/tf`; empty: none is sent
  /// The places of all links at these joint positions; see `places_of`.
  std::function<void(const std::vector<double>& q, std::vector<LinkPlace>& places)> places;
  std::vector<SkinCloud::Cell> cells{};  ///< cells of `/skin/cells`; their links are indices into the places
  PressedCells pressed{};                ///< cells of `/skin/contacts`; empty: none is sent
  float newtons = 1;                     ///< force for which a cell's readings add up to 1 [N]
  Nanoseconds max_age = 100ms;           ///< age of a reading above which its cell is marked as stale
};

/// The links of `D` that move, as frames.
template <NamesLinks D>
[[nodiscard]] std::vector<RunFrame> frames_of() {
  std::vector<RunFrame> out;
  for (const NamedLink& l : D::named_links)
    if (l.link >= 0) out.push_back({l.name, static_cast<std::size_t>(l.link), {l.R, l.p}});
  return out;
}

/// The links of the robot of a URDF that move, as frames; `RunDescription::urdf` is the text of its file.
[[nodiscard]] inline std::vector<RunFrame> frames_of(const Urdf& urdf) {
  std::vector<RunFrame> out;
  for (const UrdfFrame& f : urdf.frames)
    if (f.joint >= 0) out.push_back({f.name, static_cast<std::size_t>(f.joint), {f.R, f.p}});
  return out;
}

/// Adds the cells of a skin, as `skin_patches` of a skin file places them: they are drawn, and those that are
/// pressed become contacts.
inline void add_cells(RunDescription& run, const std::vector<SkinPatch>& patches) {
  for (std::size_t number = 0; number < patches.size(); ++number)
    for (const SkinCell& cell : patches[number].cells) {
      const auto& p = cell.X_LC.origin();
      run.pressed.places.push_back({patches[number].link, number, p, cell.X_LC.axis_z()});
      run.pressed.ids.push_back(cell.id);
      run.cells.push_back({cell.id,
                           static_cast<std::uint32_t>(patches[number].link),
                           {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}});
    }
  std::stable_sort(run.cells.begin(), run.cells.end(),
                   [](const auto& a, const auto& b) { return a.link < b.link; });
}

/// The places of a model's links, for `RunDescription::places`. The model is copied.
template <RobotModel M>
[[nodiscard]] auto places_of(const M& model) {
  return [model](const std::vector<double>& q, std::vector<LinkPlace>& places) {
    JointPosition<M::joints> at;
    for (std::size_t i = 0; i < M::joints && i < q.size(); ++i) at[i] = q[i];
    const auto poses = link_poses(model, at);
    places.resize(M::joints);
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      ((places[Ix] = {poses.template get<Ix>().axes(), poses.template get<Ix>().origin()}), ...);
    }(std::make_index_sequence<M::joints>());
  };
}

SKINCTL_END_NAMESPACE
