// SPDX-License-Identifier: BSD-3-Clause
// Commands: what leaves for a robot, and the motion and torque behind it.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The interface of a joint: the numbers of a command that the robot executes.
enum class Interface : unsigned char {
  position,  ///< `position`, which the robot reaches and keeps
  velocity,  ///< `velocity`, which the robot holds until the next command
  torque,    ///< `torque`, held until the next command
  impedance  ///< `position`, about which a spring of the robot holds, and `torque` beside it
};
inline constexpr Interface all_interfaces[] = {Interface::position, Interface::velocity, Interface::torque,
                                               Interface::impedance};

/// Whether a command of the interface holds positions; below, velocities and torques.
[[nodiscard]] constexpr bool takes_position(Interface i) noexcept {
  return i == Interface::position || i == Interface::impedance;
}
[[nodiscard]] constexpr bool takes_velocity(Interface i) noexcept {
  return i == Interface::velocity;
}
[[nodiscard]] constexpr bool takes_torque(Interface i) noexcept {
  return i == Interface::torque || i == Interface::impedance;
}

/// The plan of a cycle for `time`, between its stages and for those who watch: the commanded motion, whatever
/// the interface, and the torque: the fused one (beside a motion the last finite one), or by impedance the
/// torque that the motion takes. A robot gets a `RobotCommand`.
template <std::size_t N, Real T = double>
struct JointCommand {
  Nanoseconds time{};
  bool valid = false;
  JointPosition<N, T> position;
  JointVelocity<N, T> velocity;
  JointAcceleration<N, T> acceleration;
  JointTorque<N, T> torque;
};

namespace detail {
template <std::size_t N, Real T>
struct CommandedPosition {
  JointPosition<N, T> position;  ///< commanded positions [rad], [m]
  SKINCTL_INLINE explicit CommandedPosition(const JointCommand<N, T>& c) noexcept : position(c.position) {}
  CommandedPosition() = default;
};
template <std::size_t N, Real T>
struct CommandedVelocity {
  JointVelocity<N, T> velocity;  ///< commanded velocities [rad/s], [m/s]
  SKINCTL_INLINE explicit CommandedVelocity(const JointCommand<N, T>& c) noexcept : velocity(c.velocity) {}
  CommandedVelocity() = default;
};
template <std::size_t N, Real T>
struct CommandedTorque {
  JointTorque<N, T> torque;  ///< commanded torques [N m], [N]
  SKINCTL_INLINE explicit CommandedTorque(const JointCommand<N, T>& c) noexcept : torque(c.torque) {}
  CommandedTorque() = default;
};
/// `Numbers` of a command, or nothing in place of numbers that no interface takes.
template <bool Takes, class Numbers>
struct IfTaken : Numbers {
  using Numbers::Numbers;
};
template <class Numbers>
struct IfTaken<false, Numbers> {
  SKINCTL_INLINE explicit IfTaken(const auto&) noexcept {}
  IfTaken() = default;
};
}  // namespace detail

/// The command that a robot is sent: the numbers that its interfaces take, in members `position`, `velocity`,
/// `torque`, and no others: what no limit has judged cannot be sent. Of a robot in groups, N counts all its
/// joints: `Resolver::stiff(command)`, `Resolver::torque(command)` and `part_of<Set>(command)` are the parts
/// for its devices.
///
/// While `valid` is false the command must not be sent: no good measurement of the robot has arrived yet, or
/// it shows the robot elsewhere than where it was started. A cycle's position is then the measured one, or
/// NaN where the robot cannot be there, and its velocity zero.
template <std::size_t N, Real T, Interface... Ix>
struct RobotCommand : detail::IfTaken<(takes_position(Ix) || ...), detail::CommandedPosition<N, T>>,
                      detail::IfTaken<(takes_velocity(Ix) || ...), detail::CommandedVelocity<N, T>>,
                      detail::IfTaken<(takes_torque(Ix) || ...), detail::CommandedTorque<N, T>> {
  static constexpr bool holds_position = (takes_position(Ix) || ...);
  static constexpr bool holds_velocity = (takes_velocity(Ix) || ...);
  static constexpr bool holds_torque = (takes_torque(Ix) || ...);
  Nanoseconds time{};
  bool valid = false;

  RobotCommand() = default;
  SKINCTL_INLINE explicit RobotCommand(const JointCommand<N, T>& planned) noexcept
      : detail::IfTaken<holds_position, detail::CommandedPosition<N, T>>(planned),
        detail::IfTaken<holds_velocity, detail::CommandedVelocity<N, T>>(planned),
        detail::IfTaken<holds_torque, detail::CommandedTorque<N, T>>(planned),
        time(planned.time),
        valid(planned.valid) {}

  /// Calls `f(command.position...)` with the positions of some commands of this type, then with their
  /// velocities and torques, as far as the type has them.
  template <class F, class... Commands>
  static SKINCTL_INLINE void each(F&& f, Commands&... command) noexcept {
    if constexpr (holds_position) f(command.position...);
    if constexpr (holds_velocity) f(command.velocity...);
    if constexpr (holds_torque) f(command.torque...);
  }
};
template <std::size_t N, Real T = double>
using PositionCommand = RobotCommand<N, T, Interface::position>;
template <std::size_t N, Real T = double>
using VelocityCommand = RobotCommand<N, T, Interface::velocity>;
template <std::size_t N, Real T = double>
using TorqueCommand = RobotCommand<N, T, Interface::torque>;
template <std::size_t N, Real T = double>
using ImpedanceCommand = RobotCommand<N, T, Interface::impedance>;

SKINCTL_END_NAMESPACE
