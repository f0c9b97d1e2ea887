// How late the machine runs what is due, beside a job in real time: deadlines that were missed while it slept
// are not the job's.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

#include "skinctl/hardware/histogram.hpp"

namespace examples {

/// A thread without work that asks to be woken each millisecond, from construction to `stop`.
class MachineWatch {
 public:
  MachineWatch() : thread_([this] { keep(); }) {}
  ~MachineWatch() { stop(); }
  MachineWatch(const MachineWatch&) = delete;
  MachineWatch& operator=(const MachineWatch&) = delete;

  void stop() {
    end_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// How late it was woken; after `stop`.
  [[nodiscard]] const skinctl::Histogram& late() const noexcept { return late_; }
  /// How often by more than a millisecond: half a period of 500 Hz.
  [[nodiscard]] std::uint64_t by_a_millisecond() const noexcept { return by_a_millisecond_; }

 private:
  using Clock = std::chrono::steady_clock;
  void keep() {
    for (auto due = Clock::now() + std::chrono::milliseconds(1); !end_;) {
      std::this_thread::sleep_until(due);
      const auto now = Clock::now();
      late_.record(now - due);
      by_a_millisecond_ += now - due > std::chrono::milliseconds(1);
      due = now - due > std::chrono::milliseconds(1) ? now + std::chrono::milliseconds(1)
                                                     : due + std::chrono::milliseconds(1);
    }
  }

  skinctl::Histogram late_;
  std::uint64_t by_a_millisecond_ = 0;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace examples
