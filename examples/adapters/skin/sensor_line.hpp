// A sensor at a serial line whose messages have no stamp.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "examples/adapters/serial.hpp"
#include "skinctl/sensing/cell_sample.hpp"

namespace adapters::skin {

/// Samples of one cell from a serial line. A message gets the time at which it was read; of several that were
/// read at once the earlier ones lie `Parser::max_step` apart, as the sensor sends them, or closer where the
/// last reading was less long ago.
///
/// @tparam Parser  `take(bytes, f)` calls `f` with each message that bytes end, `counts()` tells of them;
///                 `size` is the bytes of a message.
template <class Kind, class Parser>
class SensorLine {
 public:
  using Sample = skinctl::SensorSample<Kind>;
  /// Of one poll; more wait in the system.
  static constexpr std::size_t max_messages = 64;

  /// @param cell  id of the sensor in its samples. Throws `ConnectionError` where `device` is no serial line.
  explicit SensorLine(const std::string& device, std::uint32_t cell = 0, unsigned speed = 115200)
      : fd_(open_serial(device, speed)), cell_(cell) {}

  /// The board was unplugged, or its end of the line was closed.
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] const typename Parser::Counts& counts() const noexcept { return parser_.counts(); }

 protected:
  /// The measurements that have arrived, waiting for the first one until `deadline`; `now` is asked for the
  /// time [ns], never falling, once there are some. Empty: none came, or the line is closed.
  ///
  /// @param make  writes a sample, but for cell and time, of a message; false: it is no measurement.
  template <class Now, class Make>
  [[nodiscard]] std::span<const Sample> poll(can::Deadline deadline, Now&& now, Make&& make) {
    std::size_t count = 0;
    // No more bytes than messages that there is room for.
    std::array<std::uint8_t, (max_messages - 1) * Parser::size> bytes;
    for (bool looked = false; count == 0 && !closed_; looked = true) {
      if (looked && std::chrono::steady_clock::now() >= deadline) break;  // whatever it floods us with
      std::size_t n = 0;
      const Read read = read_some(fd_, bytes, n, deadline);
      closed_ = read == Read::closed;
      if (read != Read::some) break;
      parser_.take(std::span(bytes).first(n), [&](const auto& message) {
        Sample& s = samples_[count] = {.cell = cell_};
        count += make(message, s) ? 1u : 0u;
      });
    }
    if (count == 0) return {};
    const skinctl::Nanoseconds t = now();
    const auto n = static_cast<std::int64_t>(count);
    const auto step = heard_ ? std::min((t - last_) / n, Parser::max_step) : Parser::max_step;
    for (std::int64_t k = 0; k < n; ++k) samples_[static_cast<std::size_t>(k)].time = t - (n - 1 - k) * step;
    last_ = t, heard_ = true;
    return std::span(samples_).first(count);
  }

 private:
  can::Descriptor fd_;
  std::uint32_t cell_;
  Parser parser_;
  std::array<Sample, max_messages> samples_{};
  skinctl::Nanoseconds last_{};
  bool heard_ = false, closed_ = false;
};

}  // namespace adapters::skin
