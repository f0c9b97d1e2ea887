// Limits of the hand's joints.
#pragma once

#include "examples/adapters/allegro/frames.hpp"
#include "skinctl/robot/joint_limits.hpp"

namespace adapters::allegro {

/// Range of the joints of both hands [rad]: allegro_right_hand.urdf of Gepetto/example-robot-data. Its 7
/// rad/s and 15 N m are no property of the hand; torques are limited by what the hand takes.
inline constexpr std::array<double, 16> lower = {-0.47,  -0.196, -0.174, -0.227, -0.47,  -0.196,
                                                 -0.174, -0.227, -0.47,  -0.196, -0.174, -0.227,
                                                 0.263,  -0.105, -0.189, -0.162};
inline constexpr std::array<double, 16> upper = {0.47, 1.61, 1.709, 1.618, 0.47,  1.61,  1.709, 1.618,
                                                 0.47, 1.61, 1.709, 1.618, 1.396, 1.163, 1.644, 1.719};

/// Limits for a description of the hand by torque; the torques are those that its wire can carry.
[[nodiscard]] inline skinctl::JointLimits<16> limits(const TorqueScale& scale, double velocity = 7,
                                                     double acceleration = 500) {
  using namespace skinctl;
  return JointLimits<16>({.lower = JointPosition<16>(lower),
                          .upper = JointPosition<16>(upper),
                          .velocity = JointVelocity<16>::constant(velocity),
                          .acceleration = JointAcceleration<16>::constant(acceleration),
                          .torque = scale.limit()});
}

}  // namespace adapters::allegro
