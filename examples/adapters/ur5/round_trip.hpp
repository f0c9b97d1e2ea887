// How long a number takes to the controller and back: measured before anything moves.
#pragma once

#include "examples/adapters/socket.hpp"
#include "skinctl/core/time.hpp"

namespace adapters::ur5 {

struct RoundTrip {
  int echoes = 0;
  skinctl::Nanoseconds median{},
      longest{};  ///< by this computer's clock, from writing until the echo is read
  /// By the controller's time stamps: from the state that was answered until the state that shows the answer.
  skinctl::Nanoseconds controller_median{}, controller_longest{};
};

/// Writes `input_int_register_24` and waits until the outputs show it, `echoes` times, on an RTDE connection
/// of its own. Moves nothing. Throws `ConnectionError`, also if another client holds the register.
[[nodiscard]] RoundTrip measure_round_trip(const std::string& host, std::uint16_t rtde_port, double rate,
                                           int echoes = 50, Timeout timeout = Timeout(5000));

}  // namespace adapters::ur5
