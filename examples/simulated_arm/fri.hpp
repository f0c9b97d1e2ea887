// A simulated iiwa whose Java program overlays a position hold by FRI.
#pragma once

#include "examples/adapters/fri/fri.hpp"
#include "examples/simulated_arm/controller.hpp"
#include "examples/simulated_arm/spring_arm.hpp"

namespace simulated_arm {

using SpringController = ControllerOf<SpringArm>;
using SpringFace = FaceOf<SpringArm>;

/// As the Java program says it, and what the maker does not publish: how quality is judged is assumed.
struct FriConfig {
  unsigned send_period = 4;  ///< [ms]
  unsigned multiplier = 1;   ///< receive multiplier
  adapters::fri::Control control = adapters::fri::Control::joint_impedance;
  adapters::fri::Overlay overlay = adapters::fri::Overlay::position;
  bool motion_begins = true;      ///< under the overlay
  bool tells_commanded = true;    ///< false: as version 2 of FRI
  bool tells_external = true;     ///< torque of the world
  unsigned before = 5;            ///< answers in each session state before the next one
  double good = 0.2, fair = 0.4;  ///< share of the last 100 answers that may be missing: for GOOD, for FAIR
  double max_speed = 1.483;       ///< of a command; beyond it the motion ends [rad/s]
  double motion_ends_at =
      -1;               ///< the Java program's motion ends: the session falls back [s]; negative: never
  double poor_at = -1;  ///< the controller judges the quality poor [s]; negative: never
  SpringArmConfig arm{};
};

[[nodiscard]] std::unique_ptr<SpringFace> fri_face(const Config& config, const FriConfig& fri);
/// Sends to `host:port`; `model`: of the arm's body.
[[nodiscard]] std::unique_ptr<SpringController> fri_controller(const SpringArm::Model& model,
                                                               const Config& config, const FriConfig& fri,
                                                               const std::string& host, std::uint16_t port);

}  // namespace simulated_arm
