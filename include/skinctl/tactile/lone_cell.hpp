// SPDX-License-Identifier: BSD-3-Clause
// The force that dry friction holds, wherever the arm stands: what one cell alone may count up to.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/tactile/cell_graph.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The lone force F_1 of each cell [N]: a push up to it, along the cell's normal, moves no joint in any pose,
/// because it gives no joint more than `share` of its Coulomb friction:
///
///     F_1 = share min_j tau_c,j / lever_j
///
/// over the joints that carry the cell. The lever of the link's own joint is exact; those before it have
/// upper bounds over all poses, the sum of the distances between the joints' origins from the axis to the
/// cell. A joint that slides, such as those of a base on wheels, has the lever 1: its friction is a force. 0
/// where a joint has no friction.
///
/// @param coulomb  tau_c [N m], [N]: of the virtual robot (`coulomb_friction` of its configuration), or, by
///   torque, the joints' own friction as far as nobody compensates it.
/// Throws `ConfigurationError` for friction below 0, a `share` outside (0, 1], and a cell before which a
/// prismatic joint follows a revolute one: how far it slides away from that axis is not known.
template <RobotModel M, Real T>
[[nodiscard]] SKINCTL_COLD std::vector<double> lone_forces(const M& model,
                                                           const JointTorque<M::joints, T>& coulomb,
                                                           std::span<const CellPlace> cells,
                                                           double share = 0.9) {
  constexpr std::size_t n = M::joints;
  require(share > 0 && share <= 1, "lone_forces: share", share, "> 0, <= 1");
  for (std::size_t j = 0; j < n; ++j)
    require(coulomb[j] >= T(0) && double(coulomb[j]) <= 1e6, "lone_forces: Coulomb friction",
            double(coulomb[j]), "0 to 1e6 N m");
  std::array<Xyz<double>, n> origin, axis;
  const auto poses = link_poses(model, JointPosition<n>{});
  [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
    ((origin[Ix] = poses.template get<Ix>().origin(), axis[Ix] = poses.template get<Ix>().axis_z()), ...);
  }(std::make_index_sequence<n>{});

  std::vector<double> out;
  out.reserve(cells.size());
  for (const CellPlace& c : cells) {
    require(c.link < n, "lone_forces: link of a cell", double(c.link), "a link of the model");
    const Xyz<double> moment = cross(c.place, c.normal);
    double far = std::sqrt(dot(c.place, c.place)), most = 1e300;
    const auto turns = [](std::size_t joint) { return M::kinds[joint] == JointKind::revolute; };
    const auto hold = [&](std::size_t joint, double lever) {
      const double force = share * double(coulomb[joint]) / (lever > 1e-9 ? lever : 1e-9);
      most = force < most ? force : most;
    };
    hold(c.link, turns(c.link) ? std::abs(moment.z) : std::abs(c.normal.z));
    for (std::size_t child = c.link; M::parents[child] >= 0;) {
      const auto joint = static_cast<std::size_t>(M::parents[child]);
      const Xyz<double> way = origin[child] - origin[joint], across = cross(axis[joint], way);
      require(turns(child) || !turns(joint), "lone_forces: prismatic joint", double(child),
              "before every revolute one on the way to a cell");
      hold(joint, turns(joint) ? std::sqrt(dot(across, across)) + far : 1);
      far += std::sqrt(dot(way, way));
      child = joint;
    }
    out.push_back(most);
  }
  return out;
}
/// The lone force F_1 of each cell of a described robot [N], the largest push on it that moves no joint: for
/// the `coulomb_friction` of the configuration.
template <class R>
[[nodiscard]] SKINCTL_COLD std::vector<double> lone_forces(const R& robot, std::span<const CellPlace> cells,
                                                           double share = 0.9) {
  return lone_forces(robot.model(), robot.configuration().coulomb_friction, cells, share);
}

SKINCTL_END_NAMESPACE
