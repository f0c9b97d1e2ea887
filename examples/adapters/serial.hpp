// A serial line: opened raw at a speed, with DTR set, and read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "examples/adapters/can/link.hpp"

namespace adapters {

/// Opens `device`, such as /dev/ttyACM0, for bytes as they are: 8 data bits, no parity, no flow control,
/// reads and writes that do not wait. DTR is set, which boards with USB of their own wait for before they
/// talk. What arrived before is dropped.
///
/// @param speed  9600, 115200, 230400, 460800, 921600 or 1000000 bits a second; boards with USB of their own
/// ignore it. Throws `ConnectionError` where there is no serial line, or the speed is another.
[[nodiscard]] can::Descriptor open_serial(const std::string& device, unsigned speed);

/// Reads what has come from a line that was opened so: `count` bytes, at least one if it returns `some`;
/// waits for the first one at most until `deadline`.
Read read_some(const can::Descriptor& line, std::span<std::uint8_t> into, std::size_t& count,
               can::Deadline deadline) noexcept;

}  // namespace adapters
