// The realtime port 30003: one packet of doubles per control cycle.
#pragma once

#include <cstdint>
#include <vector>

#include "examples/simulated_ur5/state.hpp"
#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5::realtime {

/// Bytes of a packet, its size field included: 1116 of PolyScope 3.10 and later, 1220 of 5.10 and later.
constexpr std::size_t packet_size(Series series) {
  return series == Series::cb3 ? 1116 : 1220;
}

void write_packet(std::vector<std::uint8_t>& out, const RobotState& state, Series series);

}  // namespace simulated_ur5::realtime
