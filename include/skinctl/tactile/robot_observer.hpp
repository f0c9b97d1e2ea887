// SPDX-License-Identifier: BSD-3-Clause
// Touch felt by a robot that finds the torque of contacts itself.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/tactile/motor_touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Observer in place of `MomentumObserver` for a robot whose controller tells the torque of contacts at its
/// joints, from torque sensors and a model of its own, as KUKA's iiwa (`externalTorque`) and Franka's FR3
/// (`tau_ext_hat_filtered`): the residual is that torque, and no mass of our model enters it. A load that the
/// robot was not told of is in it.
template <RobotModel M, Real T = double>
class RobotObserver {
 public:
  static constexpr std::size_t joints = M::joints;
  struct Settings {};
  struct Memory {
    bool started = false;
    Nanoseconds stamp{};              ///< stamp of the last sample
    JointTorque<joints, T> residual;  ///< torque of contacts at `stamp` [N m]
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  SKINCTL_COLD explicit RobotObserver(const M& model, const Settings& = {}) : model_(model) {}
  [[nodiscard]] const M& model() const noexcept { return model_; }
  /// The torque of contacts that the robot would tell on a base at rest [N m]: its controller takes the
  /// torque `adds` of the base's motion for a contact.
  [[nodiscard]] static JointTorque<joints, T> at_rest(const JointTorque<joints, T>& external,
                                                      const JointTorque<joints, T>& adds) noexcept {
    return external + adds;
  }

  /// Takes the torque that the robot tells with a measured state [N m].
  ///
  /// Ignored and reported: numbers that are not finite or absurd (`sample_not_finite`), a stamp that is not
  /// later than the last one (`time_backwards`).
  Status observe(Memory& memory, const State<joints, T>& measured,
                 const JointTorque<joints, T>& external) const noexcept {
    T sum(0);
    for (std::size_t i = 0; i < joints; ++i) sum = sum + external[i] * T(0);
    if (!detail::is_plausible(measured) || !detail::is_plausible(measured.time) || !(sum == T(0)))
      return Reason::sample_not_finite;
    if (memory.started && measured.time <= memory.stamp) return Reason::time_backwards;
    memory = {true, measured.time, external};
    return {};
  }

 private:
  [[no_unique_address]] M model_;
};

/// `MotorTouch` that reads the torque of contacts as the robot tells it:
///
///     Cycle(by_impedance(model, c), RobotTouch<Model>(model, {.gates = same_gate(model, EventGate<>::dead_band(2))}),
///           law)
template <RobotModel M, Real T = double>
using RobotTouch = MotorTouch<M, T, RobotObserver<M, T>>;

SKINCTL_END_NAMESPACE
