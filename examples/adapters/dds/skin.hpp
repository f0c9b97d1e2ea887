// A skin that comes over DDS, as a source of samples for a loop.
#pragma once

#include <atomic>
#include <cstring>
#include <thread>

#include "examples/adapters/dds/raw.hpp"
#include "skinctl/io/skin_cloud_reader.hpp"
#include "skinctl/recording/cycle_ring.hpp"
#include "skinctl/sensing/clock_offset.hpp"

namespace adapters::dds {

/// The bytes of `/skin/cells` with so many cells, whatever the frame is called (up to 256 bytes).
constexpr std::size_t skin_cloud_size(std::size_t cells) noexcept {
  return 1024 + cells * sizeof(skinctl::SkinPoint);
}

/// Reads `/skin/cells` in a thread of its own; the loop takes samples out of a ring, without a lock or a
/// system call. Stamps are the sender's; they become the robot's by `ClockOffset`.
class SkinReader {
 public:
  /// Room for `most` cells. Throws `skinctl::ConfigurationError`.
  SkinReader(Participant& participant, std::size_t most, const std::string& topic = "/skin/cells")
      : reader_(participant, topic, skinctl::SkinCloud::type(), Delivery::sensor, skin_cloud_size(most)),
        cloud_(most),
        samples_(4 * most),
        thread_([this] { run(); }) {}
  ~SkinReader() {
    ending_ = true;
    thread_.join();
  }
  SkinReader(const SkinReader&) = delete;
  SkinReader& operator=(const SkinReader&) = delete;

  /// The loop: the samples that are new, stamped on the robot's clock, which shows `now`. Empty until the
  /// clocks are tied. Valid until the next call; allocates nothing. Of more messages at once than it has room
  /// for, the last samples are dropped and counted.
  std::span<const skinctl::CellSample> poll(skinctl::Nanoseconds now) noexcept {
    std::size_t count = 0;
    ring_.consume([&](std::span<const unsigned char> bytes) {
      std::int64_t sent = 0;
      std::memcpy(&sent, bytes.data(), sizeof sent);
      static_cast<void>(offset_.hear(clocks_, skinctl::Nanoseconds(sent), now));
      if (!skinctl::ClockOffset::ready(clocks_)) return;
      for (std::size_t at = sizeof sent; bytes.size() - at >= sizeof(skinctl::CellSample);
           at += sizeof(skinctl::CellSample)) {
        if (count == samples_.size()) {
          ++dropped_;
          continue;
        }
        skinctl::CellSample& s = samples_[count++];
        std::memcpy(&s, bytes.data() + at, sizeof s);
        s.time = skinctl::ClockOffset::stamp(clocks_, s.time);
      }
    });
    return std::span(samples_).first(count);
  }
  /// Samples and messages for which there was no room.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_ + ring_.dropped(); }
  /// Messages that were no skin.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }
  [[nodiscard]] int writers() const { return reader_.writers(); }

 private:
  void run() {
    while (!ending_) {
      if (!reader_.wait(std::chrono::milliseconds(50))) continue;
      const auto message = reader_.take();
      if (!message) continue;
      const auto samples = cloud_.read(*message);
      refused_ = cloud_.refused();
      if (samples.empty()) continue;
      const std::int64_t sent = cloud_.stamp().count();
      const auto room = ring_.claim(sizeof sent + samples.size_bytes());
      if (room.empty()) continue;
      std::memcpy(room.data(), &sent, sizeof sent);
      std::memcpy(room.data() + sizeof sent, samples.data(), samples.size_bytes());
      ring_.publish(room.size());
    }
  }

  RawReader reader_;
  skinctl::SkinCloudReader cloud_;
  skinctl::CycleRing ring_{std::size_t(1) << 20};
  skinctl::ClockOffset offset_;
  skinctl::ClockOffset::Memory clocks_{};
  std::vector<skinctl::CellSample> samples_;
  std::uint64_t dropped_ = 0;
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace adapters::dds
