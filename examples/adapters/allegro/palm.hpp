// What the palm of a hand feels, passed on to the arm that carries it: from one loop to the other, without a
// lock.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

#include "skinctl/sensing/cell_sample.hpp"

namespace adapters::allegro {

/// One writer, one reader, each in its own loop; the newest reading counts. Neither waits for the other.
class Palm {
 public:
  using Clock = std::chrono::steady_clock;

  /// Whether the hand has spoken.
  [[nodiscard]] bool heard() const noexcept { return number_ > 1; }
  /// By the arm's job when it has ended: nobody feels the palm any more.
  void leave() noexcept { left_ = true; }
  [[nodiscard]] bool left() const noexcept { return left_; }
  /// By the hand's loop. @param reading  0 to 1.
  void put(float reading, Clock::time_point at = Clock::now()) noexcept {
    const std::uint32_t n = number_.load(std::memory_order_relaxed);
    number_.store(n + 1, std::memory_order_relaxed);  // odd: being written
    std::atomic_thread_fence(std::memory_order_release);
    reading_.store(reading, std::memory_order_relaxed);
    at_.store(at.time_since_epoch().count(), std::memory_order_relaxed);
    number_.store(n + 2, std::memory_order_release);
  }
  /// By the arm's loop: a reading that it has not had yet, as a sample of `cell` on the clock that shows
  /// `now`. Nothing while one is being written: it comes with the next cycle.
  [[nodiscard]] std::optional<skinctl::CellSample> take(std::uint32_t cell,
                                                        skinctl::Nanoseconds now) noexcept {
    const std::uint32_t before = number_.load(std::memory_order_acquire);
    if (before == taken_ || before % 2 != 0) return std::nullopt;
    const float f = reading_.load(std::memory_order_relaxed);
    const Clock::time_point at{Clock::duration(at_.load(std::memory_order_relaxed))};
    std::atomic_thread_fence(std::memory_order_acquire);
    if (number_.load(std::memory_order_relaxed) != before) return std::nullopt;
    taken_ = before;
    const skinctl::Nanoseconds age = Clock::now() - at;
    // Its readings are numbered: one that repeats is of a palm that lives. The number stands where this cell
    // has no accelerometer.
    return skinctl::CellSample{.time = age > skinctl::Nanoseconds(0) ? now - age : now,
                               .cell = cell,
                               .force = {f, f, f},
                               .acceleration = {static_cast<float>(before / 2 % 256), 0, 0}};
  }

 private:
  std::atomic<std::uint32_t> number_{0};
  std::atomic<float> reading_{0};
  std::atomic<Clock::rep> at_{0};
  std::atomic<bool> left_{false};
  std::uint32_t taken_ = 0;  ///< the reader's
};

}  // namespace adapters::allegro
