// The command for a robot: one number per joint, for one of three interfaces.
#pragma once

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
/// interface, so that a robot may take the others as feed-forward; `torque` is the fused torque.
///
/// While `valid` is false the command must not be sent: no good measurement of the robot has arrived yet.
template <std::size_t N, Real T = double>
struct JointCommand {
  Nanoseconds time{};
  bool valid = false;  // not the last member: GCC copies a struct that ends with padding byte by byte
  JointPosition<N, T> position;
  JointVelocity<N, T> velocity;
  JointAcceleration<N, T> acceleration;
  JointTorque<N, T> torque;

  /// `*this = other`, number by number: GCC copies the whole struct with an instruction that starts slowly.
  SKINCTL_INLINE void assign(const JointCommand& other) noexcept {
    time = other.time;
    valid = other.valid;
    position = other.position;
    velocity = other.velocity;
    acceleration = other.acceleration;
    torque = other.torque;
  }
  [[nodiscard]] SKINCTL_INLINE JointCommand copy() const noexcept {
    return {time, valid, position, velocity, acceleration, torque};
  }
};

SKINCTL_END_NAMESPACE
