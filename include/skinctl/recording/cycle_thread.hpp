// SPDX-License-Identifier: BSD-3-Clause
// The one thread beside a loop that writes and sends what the loop hands over.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include "skinctl/recording/cycle_hand_over.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A consumer of cycles beside the loop, which writes, streams or publishes them. Called by one thread; may
/// take its time, at the cost of dropped cycles when the ring is full.
template <class C>
class CycleConsumer {
 public:
  using Beginning = typename CycleBytes<C>::Beginning;
  virtual ~CycleConsumer() = default;
  /// Takes the start of the scene. `bytes` are those of `CycleBytes`.
  virtual void start(const Beginning& begin, std::span<const unsigned char> bytes) = 0;
  virtual void cycle(const CycleRecord<C>& record) = 0;
  /// Called about every 2 ms, when all cycles so far have been handed out; `dropped` cycles found no room.
  virtual void pause(std::uint64_t dropped) { static_cast<void>(dropped); }
};

/// Hands the cycles of a loop to consumers, in a thread of its own. In the loop it is a recorder of
/// `run_loop`, or `start` once, then the object itself.
template <class C>
class CycleThread {
 public:
  using Format = CycleBytes<C>;

  /// Starts the thread. The consumers stay the caller's, and outlive this object. `bytes` of the ring: a
  /// power of two from 4 KiB to 1 GiB, else `ConfigurationError`.
  explicit CycleThread(std::vector<CycleConsumer<C>*> consumers, std::size_t bytes = std::size_t(16) << 20)
      : hand_over_(bytes), consumers_(std::move(consumers)), thread_([this] { run(); }) {}
  ~CycleThread() { finish(); }
  CycleThread(const CycleThread&) = delete;
  CycleThread& operator=(const CycleThread&) = delete;

  /// Hands over, from the loop, the start of the scene at `measured`, perhaps told to be elsewhere.
  template <class... Told>
  void start(const typename Format::State& measured, const Told&... told) noexcept {
    hand_over_.start(measured, told...);
  }
  /// Hands over a cycle, from the loop.
  template <class Watch>
  void operator()(const typename C::Input& input, const typename C::Output& out,
                  const Watch& watch) noexcept {
    hand_over_(input, out, watch);
  }
  /// Waits until the ring has room: for a simulation that runs faster than its time, never for a robot.
  void wait() const {
    while (hand_over_.used() > 0.5) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  /// Ends the thread, after the loop: what is still in the ring is handed out.
  void finish() {
    ending_.store(true, std::memory_order_release);
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return hand_over_.dropped(); }

 private:
  void run() {
    for (bool ending = false; !ending;) {
      ending = ending_.load(std::memory_order_acquire);
      hand_over_.consume(
          [&](const auto& begin, std::span<const unsigned char> bytes) {
            for (auto* c : consumers_) c->start(begin, bytes);
          },
          [&](const CycleRecord<C>& record) {
            for (auto* c : consumers_) c->cycle(record);
          });
      for (auto* c : consumers_) c->pause(hand_over_.dropped());
      if (!ending) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  CycleHandOver<C> hand_over_;
  std::vector<CycleConsumer<C>*> consumers_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

SKINCTL_END_NAMESPACE
