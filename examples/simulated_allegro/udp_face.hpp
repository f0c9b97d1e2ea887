// The bytes of a simulated V5 Sense on UDP, written from the maker's tables and not from the driver that
// reads them.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "examples/simulated_allegro/body.hpp"

namespace simulated_allegro {

class UdpFace {
 public:
  using Bytes = std::vector<std::uint8_t>;
  explicit UdpFace(Body& body) : body_(body) {}

  /// Takes a datagram; true if it began a session, whose telemetry goes to its sender.
  bool take(std::span<const std::uint8_t> d) {
    if (d.size() < 16 || d[0] != 'V' || d[1] != '5' || d[2] != 'B' || d[3] != '2' || d[4] != 1 ||
        d.size() < 16u + d[6] + 256u * d[7]) {
      ++body_.snapshot().nonsense;
      return false;
    }
    const bool mute = body_.config().faults.mute;
    if (d[5] == 0x10) {
      if (mute) return false;
      const auto hot = static_cast<std::uint8_t>(body_.temperature());
      answer(0x11, d, {1, 5, 2, 1, 0, hot, 1});
      if (!talks_) body_.servo(true);
      talks_ = true;
      return true;
    }
    if (d[5] == 0x34 && !mute) {
      const std::string text = body_.serial();
      answer(0x35, d, Bytes(text.begin(), text.end()));
    } else if (d[5] == 0x03 && d[6] + 256u * d[7] == 32) {
      std::array<std::array<std::int16_t, 4>, 4> fingers{};
      for (std::size_t k = 0; k < 16; ++k)
        fingers[k / 4][k % 4] = static_cast<std::int16_t>(d[16 + 2 * k] + 256 * d[17 + 2 * k]);
      body_.torque(12, fingers[0]);  // the thumb comes first
      for (std::size_t f = 0; f < 3; ++f) body_.torque(4 * f, fingers[f + 1]);
      body_.act();
      answered_ = true;
    } else {
      ++body_.snapshot().nonsense;
    }
    return false;
  }

  void tell() {
    answered_ = false;
    Body& b = body_;
    const Faults& faults = b.config().faults;
    ++b.snapshot().sets;
    if (b.past(faults.restart_at) && !restarted_) {
      restarted_ = true;
      sample_ = 0;
    }
    Bytes p;
    put(p, sample_++, 4);
    const auto joint = [](std::size_t wire) { return (wire + 12) % 16; };
    for (std::size_t k = 0; k < 16; ++k) put(p, static_cast<std::uint16_t>(b.position(joint(k))), 2);
    for (std::size_t k = 0; k < 16; ++k)
      put(p, static_cast<std::uint16_t>(std::lround(1430 * b.plant().torque()[joint(k)])), 2);
    for (std::size_t k = 0; k < 16; ++k) put(p, b.cell(k), 2);
    for (std::size_t k = 0; k < 16; ++k)
      put(p, static_cast<std::uint32_t>(static_cast<std::int32_t>(1000 * b.plant().dq()[joint(k)])), 4);
    Bytes d = datagram(0x02, sequence_++, p);
    if (b.past(faults.motor_error_at) && !failed_) {
      failed_ = true;
      queue_.push_back(datagram(0x37, sequence_++, {0x20, 0, 0, 0, 0, 0, 0, 0}));
      queue_.push_back(datagram(0x50, sequence_++, {6, 0x20}));
    }
    if (b.happens(faults.lose)) return;
    if (b.happens(faults.truncate)) d.resize(100);
    queue_.push_back(d);
    if (b.happens(faults.duplicate)) queue_.push_back(d);
    if (queue_.size() > 1 && b.happens(faults.reorder)) std::swap(queue_.front(), queue_.back());
  }

  std::deque<Bytes>& outgoing() {
    const Faults& f = body_.config().faults;
    const double t = body_.plant().time();
    if (body_.past(f.silent_at)) queue_.clear();
    const bool held = f.late_at >= 0 && t >= f.late_at && t < f.late_at + f.late_for;
    if (f.reorder > 0 && talks_ && queue_.size() == 1 && body_.happens(f.reorder)) return nothing_;
    return held ? nothing_ : queue_;
  }
  [[nodiscard]] bool talks() const noexcept { return talks_; }
  [[nodiscard]] bool answered() const noexcept { return answered_; }

 private:
  static void put(Bytes& to, std::uint32_t x, int bytes) {
    for (int k = 0; k < bytes; ++k) to.push_back(static_cast<std::uint8_t>(x >> (8 * k)));
  }
  Bytes datagram(std::uint8_t type, std::uint32_t sequence, const Bytes& payload) const {
    const bool other = body_.past(body_.config().faults.other_version_at);
    Bytes d = {'V', '5', 'B', '2', static_cast<std::uint8_t>(other ? 2 : 1), type};
    put(d, static_cast<std::uint32_t>(payload.size()), 2);
    put(d, sequence, 4);
    put(d, static_cast<std::uint32_t>(1000 * body_.plant().time()), 4);
    d.insert(d.end(), payload.begin(), payload.end());
    return d;
  }
  void answer(std::uint8_t type, std::span<const std::uint8_t> request, const Bytes& payload) {
    const std::uint32_t sequence = request[8] + 256u * request[9] + 65536u * request[10];
    queue_.push_back(datagram(type, sequence, payload));
  }

  Body& body_;
  std::deque<Bytes> queue_, nothing_;
  std::uint32_t sample_ = 0, sequence_ = 0;
  bool talks_ = false, answered_ = false, failed_ = false, restarted_ = false;
};

}  // namespace simulated_allegro
