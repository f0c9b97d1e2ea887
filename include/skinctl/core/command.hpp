// What is sent to a robot: one command per joint for one of three interfaces.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Which of a command's numbers the robot takes.
enum class Interface : unsigned char {
  position,  ///< `position`, which the robot reaches and keeps
  velocity,  ///< `velocity`, which the robot holds until the next command
  torque     ///< `torque`, held until the next command
};

/// A command at `time`. `position`, `velocity` and `acceleration` describe the commanded motion for every
/// interface, so that a robot may take the others as feed-forward; `torque` is the fused torque.
///
/// While `valid` is false there is nothing that may be sent: no good state of the robot was ever seen.
template <std::size_t N, Real T = double>
struct JointCommand {
  Nanoseconds time{};
  bool valid = false;  // not last: of a struct that ends with padding GCC copies byte by byte
  JointPosition<N, T> position;
  JointVelocity<N, T> velocity;
  JointAcceleration<N, T> acceleration;
  JointTorque<N, T> torque;

  /// `*this = other`, number by number: so much at once GCC copies with an instruction that starts slowly.
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
