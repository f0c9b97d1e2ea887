// An FR3 over the maker's libfranka, from 0.13.3 on: by joint impedance or by torque.
#pragma once

#include <franka/active_control_base.h>
#include <franka/exception.h>
#include <franka/robot.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "skinctl/hardware/robot.hpp"

namespace adapters {

/// A `RobotDriver` that takes what the interface `how` says: positions about which the robot's own springs
/// hold, or torques, to which the robot adds those for weight and friction. libfranka blocks, throws and
/// allocates where it ends a motion; nothing here throws from the first `wait` on.
template <skinctl::Interface how>
  requires(how == skinctl::Interface::impedance || how == skinctl::Interface::torque)
class LibfrankaDriver {
 public:
  static constexpr std::size_t joints = 7;
  using Numbers = std::array<double, joints>;
  static constexpr bool by_torque = how == skinctl::Interface::torque;

  /// Connects; the user sets collision thresholds and springs by `robot()`. Throws what libfranka throws.
  explicit LibfrankaDriver(const std::string& host,
                           ::franka::RealtimeConfig real_time = ::franka::RealtimeConfig::kEnforce)
      : robot_(host, real_time) {}
  ~LibfrankaDriver() { stop(); }
  LibfrankaDriver(const LibfrankaDriver&) = delete;
  LibfrankaDriver& operator=(const LibfrankaDriver&) = delete;

  /// Between motions.
  [[nodiscard]] ::franka::Robot& robot() noexcept { return robot_; }
  /// Begins the motion: from here on each state needs its answer. Throws what libfranka throws.
  void start() {
    using Mode = research_interface::robot::Move::ControllerMode;
    control_ =
        by_torque ? robot_.startTorqueControl() : robot_.startJointPositionControl(Mode::kJointImpedance);
    state_ = control_->readOnce().first;
    target_ = state_.q_d;
    torque_ = {};
    error_[0] = 0;
    due_ = true;
  }

  skinctl::Heard wait(skinctl::State<joints>& state) noexcept {
    if (!control_) return skinctl::Heard::lost;
    const bool read = due_ || guarded([&] { state_ = control_->readOnce().first; });  // that of the start
    due_ = false;
    if (!read) return skinctl::Heard::lost;
    state.time = std::chrono::milliseconds(state_.time.toMSec());
    for (std::size_t i = 0; i < joints; ++i) state.q[i] = state_.q[i], state.dq[i] = state_.dq[i];
    return skinctl::Heard::state;
  }
  bool send(const skinctl::ImpedanceCommand<joints>& c) noexcept
    requires(!by_torque)
  {
    for (std::size_t i = 0; i < joints; ++i) target_[i] = c.position[i];
    return write(target_, false);
  }
  /// Within the rate that the robot takes from one state to the next.
  bool send(const skinctl::TorqueCommand<joints>& c) noexcept
    requires by_torque
  {
    for (std::size_t i = 0; i < joints; ++i)
      torque_[i] = std::clamp(c.torque[i], state_.tau_J_d[i] - torque_step, state_.tau_J_d[i] + torque_step);
    return write(torque_, false);
  }
  /// Brings the commands to rest, and ends the motion.
  void stop() noexcept {
    if (!control_) return;
    if (error_[0] == 0) by_torque ? fade() : brake();
    // libfranka's destructor of a motion that a robot has ended throws, which ends the program, unless the
    // motion was told to be finished; one whose robot is silent cannot be told, and stays.
    if (error_[0] != 0 &&
        !guarded([&] { control_->writeOnce(command(by_torque ? Numbers{} : target_, true)); }))
      static_cast<void>(control_.release());
    control_.reset();
  }

  [[nodiscard]] skinctl::JointPosition<joints> told() const noexcept
    requires(!by_torque)
  {
    return skinctl::JointPosition<joints>(state_.q_d);
  }
  /// Torque of the world at the joints, as the robot finds it [N m].
  [[nodiscard]] skinctl::JointTorque<joints> motor_torque() const noexcept {
    return skinctl::JointTorque<joints>(state_.tau_ext_hat_filtered);
  }
  [[nodiscard]] std::uint32_t packet() const noexcept {
    return static_cast<std::uint32_t>(state_.time.toMSec());
  }
  [[nodiscard]] const ::franka::RobotState& newest() const noexcept { return state_; }
  /// What libfranka said; empty: nothing.
  [[nodiscard]] const char* error() const noexcept { return error_.data(); }

 private:
  static constexpr double torque_step = 0.95, dt = 1e-3;  // [N m], [s]

  template <class F>
  bool guarded(F&& f) noexcept {
    try {
      f();
      return true;
    } catch (const std::exception& e) {
      if (error_[0] == 0) std::snprintf(error_.data(), error_.size(), "%s", e.what());
      return false;
    }
  }
  static auto command(const Numbers& x, bool last) noexcept {
    std::conditional_t<by_torque, ::franka::Torques, ::franka::JointPositions> out(x);
    out.motion_finished = last;
    return out;
  }
  bool write(const Numbers& x, bool last) noexcept {
    return control_ && error_[0] == 0 && guarded([&] { control_->writeOnce(command(x, last)); });
  }
  bool read() noexcept {
    return guarded([&] { state_ = control_->readOnce().first; });
  }
  /// From the motion of the last command to rest, critically damped.
  void brake() noexcept {
    constexpr double settling = 0.05;  // [s]
    auto v = state_.dq_d, a = state_.ddq_d;
    for (int k = 0; k < 1000; ++k) {
      if (!read()) return;
      double fastest = 0;
      for (std::size_t i = 0; i < joints; ++i) {
        a[i] -= dt * (2 * a[i] / settling + v[i] / (settling * settling));
        v[i] += dt * a[i];
        target_[i] += dt * v[i];
        fastest = std::max({fastest, std::abs(v[i]), settling * std::abs(a[i])});
      }
      const bool last = fastest < 1e-4;
      if (!write(target_, last) || last) return;
    }
  }
  void fade() noexcept {
    for (int k = 0; k < 200; ++k) {
      if (!read()) return;
      bool last = true;
      for (double& x : torque_) {
        x = std::copysign(std::max(0.0, std::abs(x) - torque_step), x);
        last = last && x == 0;
      }
      if (!write(torque_, last) || last) return;
    }
  }

  ::franka::Robot robot_;
  std::unique_ptr<::franka::ActiveControlBase> control_;
  ::franka::RobotState state_;
  Numbers target_{}, torque_{};
  std::array<char, 512> error_{};
  bool due_ = false;  ///< the state of the start has not been handed on
};

}  // namespace adapters
