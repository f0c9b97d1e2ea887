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
  JointControlSettings<M::joints, T> s{.dt = robot.longest_dt()};
  s.virtual_dynamics = robot.virtual_dynamics();
  const auto take = [&]<class G>(const G& g) {
    using Set = JointSubset<M::joints, G::set>;
    for (std::size_t j = 0; j < Set::count; ++j) {
      const std::size_t i = Set::index[j];
      s.max_velocity[i] = std::min(s.max_velocity[i], g.configuration.limits.velocity()[j]);
      s.joint_acceleration[i] = T(detail::planned_share) * T(g.configuration.limits.acceleration()[j]);
    }
  };
  std::apply([&](const auto&... g) { (take(g), ...); }, robot.groups());
  if constexpr (GroupsDescription<M, T, std::tuple<Groups...>, Parts...>::Sets::Driven::count > 0) {
    s.loop_delay = robot.loop_delay();
    detail::follow_delay(s, seconds<T>(s.loop_delay));
    s.tb = Nanoseconds(0);
  }
  return s;
}
/// Settings of a tracking law for a robot in groups, in a scene with `MaxJerk`, which limits the joints by
/// position and velocity.
template <RobotModel M, Real T, class... Groups, class... Parts>
[[nodiscard]] JointControlSettings<M::joints, T> tracking_settings(
    const GroupsDescription<M, T, std::tuple<Groups...>, Parts...>& robot,
    const JointJerk<M::joints, T>& jerk) {
  auto s = tracking_settings(robot);
  JointAcceleration<M::joints, T> acceleration;
  const auto put = [&]<class G>(const G& g) {
    if constexpr (G::interface != Interface::torque)
      JointSubset<M::joints, G::set>::put(g.configuration.limits.acceleration(), acceleration);
  };
  std::apply([&](const auto&... g) { (put(g), ...); }, robot.groups());
  detail::fit_jerk(s,
                   jerk_terms(robot.model(), s.virtual_dynamics, acceleration, jerk, seconds<T>(robot.dt())));
  return s;
}

SKINCTL_END_NAMESPACE
