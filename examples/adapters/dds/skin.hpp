// A skin that comes over DDS, as a source of samples for a loop.
#pragma once

#include "examples/adapters/dds/raw.hpp"
#include "skinctl/io/skin_cloud_reader.hpp"
#include "skinctl/sensing/clock_offset.hpp"

namespace adapters::dds {

/// The bytes of `/skin/cells` with so many cells, whatever the frame is called (up to 256 bytes).
constexpr std::size_t skin_cloud_size(std::size_t cells) noexcept {
  return 1024 + cells * sizeof(skinctl::SkinPoint);
}

/// Reads `/skin/cells`. Stamps are the sender's; they become the robot's by `ClockOffset`.
class SkinReader {
 public:
  /// Room for `most` cells. Throws `skinctl::ConfigurationError`.
  SkinReader(Participant& participant, std::size_t most, const std::string& topic = "/skin/cells")
      : reader_(participant, topic, skinctl::SkinCloud::type(), Delivery::sensor, skin_cloud_size(most)),
        cloud_(most) {
    samples_.reserve(most);
  }

  /// The samples that are new, stamped on the robot's clock, which shows `now`. Empty until the clocks are tied. Valid
  /// until the next call. One call to the middleware: it copies the newest message, which costs 0.1 ms for 1260 cells.
  std::span<const skinctl::CellSample> poll(skinctl::Nanoseconds now) {
    samples_.clear();
    const auto message = reader_.take();
    if (!message) return {};
    const auto read = cloud_.read(*message);
    if (read.empty()) return {};
    static_cast<void>(offset_.hear(clocks_, cloud_.stamp(), now));
    if (!skinctl::ClockOffset::ready(clocks_)) return {};
    for (skinctl::CellSample s : read) {
      s.time = skinctl::ClockOffset::stamp(clocks_, s.time);
      samples_.push_back(s);
    }
    return samples_;
  }
  /// Messages that were no skin.
  [[nodiscard]] std::uint64_t refused() const noexcept { return cloud_.refused(); }
  [[nodiscard]] int writers() const { return reader_.writers(); }

 private:
  RawReader reader_;
  skinctl::SkinCloudReader cloud_;
  skinctl::ClockOffset offset_{skinctl::ClockOffset::Settings{}};
  skinctl::ClockOffset::Memory clocks_{};
  std::vector<skinctl::CellSample> samples_;
};

}  // namespace adapters::dds
