// The command for a robot: one number per joint, for one of three interfaces.
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The interface of a joint: the numbers of a command that the robot executes.
enum class Interface : unsigned char {
  position,  ///< `position`, which the robot reaches and keeps
  velocity,  ///< `velocity`, which the robot holds until the next command
  torque     ///< `torque`, held until the next command
};

/// A command at `time`. `position`, `velocity` and `acceleration` describe the commanded motion for every
/// interface, so that a robot may take the others as feed-forward; `torque` is the fused torque, beside a motion the
/// last finite one.
///
/// While `valid` is false the command must not be sent: no good measurement of the robot has arrived yet, or it
/// shows the robot elsewhere than where it was started.
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

SKINCTL_END_NAMESPACE
