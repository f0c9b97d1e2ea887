// A simulated Allegro hand on a thread, at the other end of a CAN link or of UDP on loopback.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "examples/adapters/can/link.hpp"
#include "examples/simulated_allegro/body.hpp"

namespace simulated_allegro {

/// It is plugged in once, in one of four ways, and lives until `stop()` or its end.
class SimulatedHand {
 public:
  explicit SimulatedHand(const Config& config) : body_(config) {}
  ~SimulatedHand() { stop(); }
  SimulatedHand(const SimulatedHand&) = delete;
  SimulatedHand& operator=(const SimulatedHand&) = delete;

  /// The computer's end of a socket pair that carries `struct can_frame`.
  [[nodiscard]] adapters::can::FrameSocket pair();
  /// The name of a pseudo-terminal with an slcan adapter.
  [[nodiscard]] std::string terminal();
  /// On an interface of the kernel, such as vcan0.
  void bus(const std::string& interface);
  /// The UDP port on loopback (0: any) of a V5 Sense.
  [[nodiscard]] std::uint16_t udp(std::uint16_t port = 0);

  [[nodiscard]] Snapshot snapshot() const {
    const std::lock_guard lock(mutex_);
    return shown_;
  }
  void stop();

 private:
  template <class Link>
  void serve_can(Link link);
  void serve_udp(adapters::can::Descriptor fd);
  void show() {
    const std::lock_guard lock(mutex_);
    shown_ = body_.snapshot();
  }

  Body body_;
  mutable std::mutex mutex_;
  Snapshot shown_;
  std::atomic<bool> stop_{false};
  adapters::can::Descriptor other_end_;  ///< of a pseudo-terminal: kept open, so that it may come and go
  std::thread thread_;
};

}  // namespace simulated_allegro
