// SPDX-License-Identifier: BSD-3-Clause
// An arm by velocity with a hand by torque.
#pragma once

#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The configuration of an arm with a hand by torque.
template <std::size_t Stiff, std::size_t Driven, Real T = double>
struct HybridConfiguration {
  /// The joints that take positions or velocities; also period, sub-step and stale age of the whole robot.
  RobotConfiguration<Stiff, T> stiff;
  /// Limits of the joints that take torques.
  JointLimits<Driven, T> limits;
  /// Viscous friction added to the joints that take torques [N m s/rad], >= 0.
  JointTorque<Driven, T> viscous = {};
};

namespace detail {
template <LinkMask ByTorque, Real T, RobotModel M>
using HybridConfigurationOf = HybridConfiguration<JointSubset<M::joints, ByTorque>::Others::count,
                                                  JointSubset<M::joints, ByTorque>::count, T>;
}  // namespace detail

/// A robot whose joints of the set `ByTorque` take torques, the others velocities:
/// `by_velocity_and_torque<joints_between(6, 22)>(model, {.stiff = ..., .limits = ...})`.
template <LinkMask ByTorque, Real T = double, RobotModel M, class... Parts>
[[nodiscard]] auto by_velocity_and_torque(const M& model,
                                          const detail::HybridConfigurationOf<ByTorque, T, M>& c,
                                          const Parts&... parts) {
  using Driven = JointSubset<M::joints, ByTorque>;
  RobotConfiguration<Driven::count, T> torque_driven{.limits = c.limits, .period = c.stiff.period};
  torque_driven.viscous_friction = c.viscous;
  torque_driven.substep = c.stiff.substep;
  torque_driven.longest_interval = c.stiff.longest_interval;
  torque_driven.stale_after = c.stiff.stale();
  torque_driven.torque_rate = c.stiff.torque_rate;
  return by_groups(model, velocity_joints<Driven::Others::set, T>(c.stiff),
                   torque_joints<ByTorque, T>(torque_driven), parts...);
}

SKINCTL_END_NAMESPACE
