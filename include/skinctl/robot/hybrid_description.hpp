// The description of a robot whose joints have two interfaces: an arm by velocity or position, a hand by
// torque.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/robot/robot_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The configuration of a robot of which some joints take torques.
template <std::size_t Stiff, std::size_t Driven, Real T = double>
struct HybridConfiguration {
  /// The joints that take positions or velocities; also period, sub-step and stale age of the whole robot.
  RobotConfiguration<Stiff, T> stiff;
  /// Limits of the joints that take torques.
  JointLimits<Driven, T> limits;
  /// Viscous friction added to the joints that take torques [N m s/rad], >= 0.
  JointTorque<Driven, T> viscous = {};
};

/// A model, the set of its joints that take torques (`ByTorque`), the interface of the others, and the
/// configuration of both. Made by `by_velocity_and_torque` or `by_position_and_torque`; immutable.
template <Interface I, LinkMask ByTorque, RobotModel M, Real T>
class HybridDescription {
 public:
  static constexpr Interface stiff_interface = I;
  static constexpr LinkMask by_torque = ByTorque;
  static constexpr std::size_t joints = M::joints;
  using scalar = T;
  using model_type = M;
  using Driven = JointSubset<joints, ByTorque>;
  using Stiff = typename Driven::Others;
  using Configuration = HybridConfiguration<Stiff::count, Driven::count, T>;

  HybridDescription(const M& model, const Configuration& configuration)
      : model_(model), configuration_(configuration) {
    check(configuration.stiff);
  }
  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] const Configuration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] Nanoseconds period() const noexcept { return configuration_.stiff.period; }
  [[nodiscard]] Nanoseconds dt() const noexcept {
    return planned_substep(period(), configuration_.stiff.substep);
  }

 private:
  [[no_unique_address]] M model_;
  Configuration configuration_;
};

namespace detail {
template <Interface I, LinkMask ByTorque, Real T, RobotModel M>
using HybridConfigurationOf = typename HybridDescription<I, ByTorque, M, T>::Configuration;
}  // namespace detail

/// A robot whose joints of the set `ByTorque` take torques, the others velocities:
/// `by_velocity_and_torque<joints_between(6, 22)>(model, {.stiff = ..., .limits = ...})`.
template <LinkMask ByTorque, Real T = double, RobotModel M>
[[nodiscard]] auto by_velocity_and_torque(
    const M& model, const detail::HybridConfigurationOf<Interface::velocity, ByTorque, T, M>& configuration) {
  return HybridDescription<Interface::velocity, ByTorque, M, T>(model, configuration);
}
/// The same with positions for the others.
template <LinkMask ByTorque, Real T = double, RobotModel M>
[[nodiscard]] auto by_position_and_torque(
    const M& model, const detail::HybridConfigurationOf<Interface::position, ByTorque, T, M>& configuration) {
  return HybridDescription<Interface::position, ByTorque, M, T>(model, configuration);
}

SKINCTL_END_NAMESPACE
