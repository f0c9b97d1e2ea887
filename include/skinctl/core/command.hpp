// Commands: what leaves for a robot, and the motion and torque behind it.
#pragma once

#include "skinctl/core/detail/row.hpp"
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

/// Which numbers a command of an interface holds.
[[nodiscard]] constexpr bool takes_position(Interface i) noexcept {
  return i == Interface::position || i == Interface::impedance;
}
[[nodiscard]] constexpr bool takes_velocity(Interface i) noexcept {
  return i == Interface::velocity;
}
[[nodiscard]] constexpr bool takes_torque(Interface i) noexcept {
  return i == Interface::torque || i == Interface::impedance;
}

/// What a cycle has planned for `time`, between its stages and for those who watch: the commanded motion,
/// whatever the interface, and the fused torque, beside a motion the last finite one, or by impedance that which the
/// motion takes. A robot gets a `RobotCommand`.
template <std::size_t N, Real T = double>
struct JointCommand {
  Nanoseconds time{};
  bool valid = false;  // not the last member: GCC copies a struct that ends with padding byte by byte
  JointPosition<N, T> position;
  JointVelocity<N, T> velocity;
  JointAcceleration<N, T> acceleration;
  JointTorque<N, T> torque;

  /// `*this = other`, in the blocks in which it is written and read: see `copy_row`.
  SKINCTL_INLINE void assign(const JointCommand& other) noexcept {
    time = other.time;
    valid = other.valid;
    detail::copy_row(other.position, position);
    detail::copy_row(other.velocity, velocity);
    detail::copy_row(other.acceleration, acceleration);
    detail::copy_row(other.torque, torque);
  }
  [[nodiscard]] SKINCTL_INLINE JointCommand copy() const noexcept {
    using Row = detail::Row<N, T>;
    return {time,
            valid,
            JointPosition<N, T>(Row(position)),
            JointVelocity<N, T>(Row(velocity)),
            JointAcceleration<N, T>(Row(acceleration)),
            JointTorque<N, T>(Row(torque))};
  }
};

namespace detail {
// The numbers of a command, each kind for itself; of the kinds that no interface takes nothing is left.
template <bool Takes, std::size_t N, Real T>
struct CommandedPosition {
  JointPosition<N, T> position;  ///< [rad], [m]
  SKINCTL_INLINE explicit CommandedPosition(const JointCommand<N, T>& c) noexcept
      : position(Row<N, T>(c.position)) {}
  CommandedPosition() = default;
};
template <bool Takes, std::size_t N, Real T>
struct CommandedVelocity {
  JointVelocity<N, T> velocity;  ///< [rad/s], [m/s]
  SKINCTL_INLINE explicit CommandedVelocity(const JointCommand<N, T>& c) noexcept
      : velocity(Row<N, T>(c.velocity)) {}
  CommandedVelocity() = default;
};
template <bool Takes, std::size_t N, Real T>
struct CommandedTorque {
  JointTorque<N, T> torque;  ///< [N m], [N]
  SKINCTL_INLINE explicit CommandedTorque(const JointCommand<N, T>& c) noexcept
      : torque(Row<N, T>(c.torque)) {}
  CommandedTorque() = default;
};
template <std::size_t N, Real T>
struct CommandedPosition<false, N, T> {
  SKINCTL_INLINE explicit CommandedPosition(const JointCommand<N, T>&) noexcept {}
  CommandedPosition() = default;
};
template <std::size_t N, Real T>
struct CommandedVelocity<false, N, T> {
  SKINCTL_INLINE explicit CommandedVelocity(const JointCommand<N, T>&) noexcept {}
  CommandedVelocity() = default;
};
template <std::size_t N, Real T>
struct CommandedTorque<false, N, T> {
  SKINCTL_INLINE explicit CommandedTorque(const JointCommand<N, T>&) noexcept {}
  CommandedTorque() = default;
};
}  // namespace detail

/// The command that a robot is sent: the numbers that its interfaces take, in members `position`, `velocity`,
/// `torque`, and no others: what no limit has judged cannot be sent. Of a robot in groups, N counts all its
/// joints: `Resolver::stiff(command)`, `Resolver::torque(command)` and `part_of<Set>(command)` are the parts
/// for its devices.
///
/// While `valid` is false the command must not be sent: no good measurement of the robot has arrived yet, or
/// it shows the robot elsewhere than where it was started.
template <std::size_t N, Real T, Interface... I>
struct RobotCommand : detail::CommandedPosition<(takes_position(I) || ...), N, T>,
                      detail::CommandedVelocity<(takes_velocity(I) || ...), N, T>,
                      detail::CommandedTorque<(takes_torque(I) || ...), N, T> {
  static constexpr bool has_position = (takes_position(I) || ...);
  static constexpr bool has_velocity = (takes_velocity(I) || ...);
  static constexpr bool has_torque = (takes_torque(I) || ...);
  Nanoseconds time{};
  bool valid = false;

  RobotCommand() = default;
  SKINCTL_INLINE explicit RobotCommand(const JointCommand<N, T>& planned) noexcept
      : detail::CommandedPosition<has_position, N, T>(planned),
        detail::CommandedVelocity<has_velocity, N, T>(planned),
        detail::CommandedTorque<has_torque, N, T>(planned),
        time(planned.time),
        valid(planned.valid) {}
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
