// SPDX-License-Identifier: BSD-3-Clause
// Gains of a tracking law for a robot in groups of joints.
#pragma once

#include <algorithm>

#include "skinctl/robot/joint_groups.hpp"
#include "skinctl/tracking/settings.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of a tracking law for a robot in groups: one law, so the slowest loop gives the gains. Those of a
/// virtual robot where no joint takes torques; beside such joints, whose delay is in the loop, at most
/// `lambda = 0.3 / D`, `K_c = K_i1 = lambda / 4` and `K_i2 = lambda / 80`, D their delay, lag and 1.5
/// periods. Inertia, damping and friction are those of the virtual joints: friction added to joints by torque
/// is not compensated, as they give less of it where their delay is long.
template <RobotModel M, Real T, class... Groups, class... Parts>
[[nodiscard]] JointControlSettings<M::joints, T> tracking_settings(
    const GroupsDescription<M, T, std::tuple<Groups...>, Parts...>& robot) {
  Nanoseconds dt = robot.dt(), loop{};
  const auto slowest = [&]<class G>(const G& g) {
    const auto& c = g.configuration;
    if constexpr (G::interface == Interface::torque) {
      loop = std::max(loop, c.delay + c.lag + 3 * c.period / 2);
    } else {
      dt = std::max(dt, c.longest() / max_substeps);
    }
  };
  std::apply([&](const auto&... g) { (slowest(g), ...); }, robot.groups());
  JointControlSettings<M::joints, T> s{.dt = dt};
  const auto take = [&]<class G>(const G& g) {
    using Set = JointSubset<M::joints, G::set>;
    const auto& c = g.configuration;
    for (std::size_t j = 0; j < Set::count; ++j) {
      const std::size_t i = Set::index[j];
      s.max_velocity[i] = std::min(s.max_velocity[i], c.limits.velocity()[j]);
      if constexpr (G::interface != Interface::torque) {
        s.virtual_dynamics.viscous[i] = c.viscous_friction[j];
        s.virtual_dynamics.inertia[i] = c.virtual_inertia[j];
        s.virtual_dynamics.damping = c.virtual_dynamics().damping;
      }
    }
  };
  std::apply([&](const auto&... g) { (take(g), ...); }, robot.groups());
  if (loop > Nanoseconds(0)) {
    s.loop_delay = std::max(loop, dt);
    s.lambda = std::min(s.lambda, T(0.3) / seconds<T>(s.loop_delay));
    s.K_c = std::min(s.K_c, T(0.25) * s.lambda);
    s.K_i1 = std::min(s.K_i1, s.K_c), s.K_i2 = std::min(s.K_i2, s.lambda / T(80));
    s.tb = Nanoseconds(0);
  }
  return s;
}

SKINCTL_END_NAMESPACE
