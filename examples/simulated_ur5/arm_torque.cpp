// The arm under direct torque.
#include <algorithm>

#include "examples/simulated_ur5/arm.hpp"

namespace simulated_ur5 {
namespace {

/// The controller's compensation of dry friction grows to its full size at about this speed [rad/s].
constexpr double sign_speed = 0.02;

}  // namespace

void Arm::torque(const Joints& tau, const Joints& viscous_scale, const Joints& coulomb_scale) {
  mode_ = Mode::torque;
  command_ = tau;
  torque_is_fresh_ = true;
  for (std::size_t i = 0; i < joint_count; ++i) {
    viscous_scale_[i] = std::clamp(viscous_scale[i], 0.0, 1.0);
    coulomb_scale_[i] = std::clamp(coulomb_scale[i], 0.0, 1.0);
  }
}

Violation Arm::plan_torque() {
  for (const double tau : command_)
    if (!std::isfinite(tau)) return Violation::not_a_number;
  torque_is_fresh_ = false;
  const Joints gravity = gravity_torque(forward_kinematics(measured_q_));
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (std::abs(dq_[i]) > config_.velocity_limit[i]) return Violation::speed;
    const double v = measured_dq_[i];
    const double friction = viscous_scale_[i] * config_.drives.viscous[i] * v +
                            coulomb_scale_[i] * config_.drives.coulomb[i] * std::tanh(v / sign_speed);
    motor_torque_[i] =
        std::clamp(command_[i] + gravity[i] + friction, -config_.torque_limit[i], config_.torque_limit[i]);
    target_q_[i] = q_[i];
    target_ddq_[i] = (dq_[i] - target_dq_[i]) / dt_;
    target_dq_[i] = dq_[i];
  }
  return Violation::none;
}

void Arm::advance_under_torque(const Joints& load) {
  Joints torque{};
  for (std::size_t i = 0; i < joint_count; ++i) torque[i] = motor_torque_[i] + load[i];
  const double h = seconds(plant_step);
  now_ += plant_step;
  const Joints before = dq_;
  dq_ = speeds_after(q_, dq_, torque, config_.bodies, drives_, h, dry_friction_);
  for (std::size_t i = 0; i < joint_count; ++i) q_[i] += 0.5 * h * (before[i] + dq_[i]);
}

void Arm::back_to_position_control() {
  // As if the position loop had led the arm here at this speed: a target ahead by delay and lag.
  for (std::size_t i = 0; i < joint_count; ++i) {
    deflection_[i] = integral_[i] = 0;
    driven_[i] = q_[i];
    target_dq_[i] = dq_[i];
    target_q_[i] = q_[i] + dq_[i] * (config_.delay + config_.lag);
  }
  const auto size = static_cast<std::int64_t>(history_.size());
  for (std::int64_t k = 0; k < size; ++k) {
    const std::int64_t cycle = planned_ - k;
    if (cycle < 0) break;
    for (std::size_t i = 0; i < joint_count; ++i)
      history_[static_cast<std::size_t>(cycle % size)][i] =
          target_q_[i] - static_cast<double>(k) * dt_ * dq_[i];
  }
  dry_friction_ = motor_torque_ = friction_side_ = {};
  q_before_ = q_, dq_before_ = dq_;
  stop(config_.protective_deceleration);
}

}  // namespace simulated_ur5
