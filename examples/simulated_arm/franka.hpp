// A simulated FR3 that speaks the Franka Control Interface, version 7.
#pragma once

#include "examples/adapters/franka/franka.hpp"
#include "examples/simulated_arm/controller.hpp"
#include "examples/simulated_arm/spring_arm.hpp"

namespace simulated_arm {

using SpringController = ControllerOf<SpringArm>;
using SpringFace = FaceOf<SpringArm>;

/// Limits are those of Franka's data sheet and of libfranka. What Franka does not publish is assumed: where a
/// motion may begin, the thresholds of collisions before they are set, the damping of the springs.
struct FrankaConfig {
  std::uint16_t version = adapters::franka::version;  ///< that it speaks
  unsigned lost_in_a_row = 20;                        ///< cycles without a command that end a motion
  double start_tolerance = 1e-3;  ///< of a motion's first position from where the robot was told to be [rad]
  bool takes_motion = true;       ///< false: FCI is not activated, or the brakes are closed
  SpringArmConfig arm{
      .home = {0, -0.785, 0, -2.356, 0, 1.571, 0.785}, .stiffness = 3000, .delay = 0, .period = 0.001};
};

/// Waits at 127.0.0.1:`port` (0: any), for one client after the other.
[[nodiscard]] std::unique_ptr<SpringFace> franka_face(const Config& config, const FrankaConfig& franka,
                                                      std::uint16_t port);
/// `model`: of the arm's body.
[[nodiscard]] std::unique_ptr<SpringController> franka_controller(const SpringArm::Model& model,
                                                                  const Config& config,
                                                                  const FrankaConfig& franka,
                                                                  std::uint16_t port);

}  // namespace simulated_arm
