// A simulated KUKA controller whose program has switched RSI on.
#pragma once

#include "examples/adapters/rsi/rsi.hpp"
#include "examples/simulated_arm/controller.hpp"

namespace simulated_arm {

/// As the RSI configuration on the controller says it.
struct RsiConfig {
  double period = 0.004;             ///< [s]
  std::uint64_t ipoc_per_cycle = 4;  ///< RSI 3 and later: milliseconds; older: 1
  adapters::rsi::Correction correction = adapters::rsi::Correction::absolute;
  double axis_corr = 90;        ///< AXISCORR: corrections are cut there [deg]
  double axis_corr_mon = 90;    ///< AXISCORRMON: beyond it RSI stops [deg]
  double max_axis_speed = 360;  ///< of the setpoint; beyond it the drives stop [deg/s]
  bool hold_on = true;          ///< HOLDON="1": without an answer the last one holds; else none
  unsigned timeout = 100;       ///< unanswered cycles in a row
};

[[nodiscard]] std::unique_ptr<Face> rsi_face(const Config& config, const RsiConfig& rsi);
/// Sends to `host:port`.
[[nodiscard]] std::unique_ptr<Controller> rsi_controller(const Config& config, const RsiConfig& rsi,
                                                         const std::string& host, std::uint16_t port);

}  // namespace simulated_arm
