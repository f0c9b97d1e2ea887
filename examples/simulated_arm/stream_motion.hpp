// A simulated FANUC controller that runs STREAM_MOTN.
#pragma once

#include "examples/adapters/stream_motion/stream_motion.hpp"
#include "examples/simulated_arm/controller.hpp"

namespace simulated_arm {

struct StreamMotionConfig {
  std::uint32_t version = 3;  ///< 4: with a force sensor
  std::uint32_t period_ms = 8;
  std::uint32_t start_move = 1;  ///< commands that wait before motion begins, and hide as many late ones
  double coast = 0.1;            ///< in which it goes on without commands, before it stops hard [s]
  double strictness = 1;         ///< share of the limits stated at which it stops
  /// Of each axis [deg/s], [deg/s^2], [deg/s^3]. Velocities of a CRX-10iA/L; the others are assumed.
  std::array<SixJoints, 3> limits{
      {{120, 120, 180, 180, 180, 180}, {240, 240, 360, 360, 360, 360}, {1920, 1920, 2880, 2880, 2880, 2880}}};
};

[[nodiscard]] std::unique_ptr<Face> stream_motion_face(const Config& config,
                                                       const StreamMotionConfig& stream);
/// Waits at `address:port` (port 0: any).
[[nodiscard]] std::unique_ptr<Controller> stream_motion_controller(const Config& config,
                                                                   const StreamMotionConfig& stream,
                                                                   const std::string& address,
                                                                   std::uint16_t port);

}  // namespace simulated_arm
