// A simulated ABB controller whose RAPID program runs EGMRunJoint.
#pragma once

#include "examples/adapters/egm/egm.hpp"
#include "examples/simulated_arm/controller.hpp"

namespace simulated_arm {

/// As the RAPID program says it.
struct EgmConfig {
  double period = 0.004;    ///< `\SampleRate` [s]
  double max_speed = 90;    ///< `\MaxSpeedDeviation`: the setpoint goes no faster [deg/s]
  double comm_timeout = 1;  ///< `\CommTimeout`: without an answer for so long it ends [s]
  unsigned before = 3;      ///< cycles in which it tells its state and does not follow yet
};

[[nodiscard]] std::unique_ptr<Face> egm_face(const Config& config, const EgmConfig& egm);
/// Sends to `host:port`.
[[nodiscard]] std::unique_ptr<Controller> egm_controller(const Config& config, const EgmConfig& egm,
                                                         const std::string& host, std::uint16_t port);

}  // namespace simulated_arm
