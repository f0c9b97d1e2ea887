// The bytes of a simulated hand on CAN, written from the maker's guide and not from the driver that reads
// them.
#pragma once

#include <deque>
#include <vector>

#include "examples/simulated_allegro/body.hpp"

namespace simulated_allegro {

class CanFace {
 public:
  using Frame = adapters::allegro::Frame;
  explicit CanFace(Body& body) : body_(body) {}

  /// Takes a frame of the computer; answers go out by `outgoing()`.
  void take(const Frame& f) {
    const Config& c = body_.config();
    if ((f.id & 3) != c.hand) return;
    const unsigned m = f.id >> 2;
    if (f.remote) {
      if (c.faults.mute) return;
      if (m == 0x80) queue_.push_back(info());
      if (m == 0x88) queue_.push_back(serial());
    } else if (m == 0x40 || m == 0x41) {
      body_.servo(m == 0x40);
    } else if (m == 0x81 && f.size == 6) {
      period_ms_ = f.data[0] + 256 * f.data[1];
      temperature_ms_ = f.data[4] + 256 * f.data[5];
    } else if (m >= 0x60 && m <= 0x63 && f.size == 8) {
      std::array<std::int16_t, 4> value{};
      for (std::size_t i = 0; i < 4; ++i)
        value[i] = static_cast<std::int16_t>(f.data[2 * i] + 256 * f.data[2 * i + 1]);
      const unsigned finger = m - 0x60;
      body_.torque(4 * finger, value);
      fingers_ |= 1u << finger;
      if (fingers_ == 15) {
        fingers_ = 0;
        answered_ = true;
        body_.act();
      }
    } else {
      ++body_.snapshot().nonsense;
    }
  }

  /// Puts out what the hand says once every period, with its faults.
  void tell() {
    answered_ = false;
    Body& b = body_;
    const Config& c = b.config();
    ++b.snapshot().sets;
    std::vector<Frame> set;
    for (unsigned f = 0; f < 4; ++f) {
      std::array<int, 4> n{};
      for (std::size_t i = 0; i < 4; ++i) n[i] = b.position(4 * f + i);
      set.push_back(words(0x20 + f, n));
    }
    if (c.generation == Generation::v5_sense) {
      for (unsigned half = 0; half < 2; ++half) {
        Frame cells = empty(0x54 + half, 8), amps = empty(half == 0 ? 0x00 : 0x03, 8);
        for (std::size_t i = 0; i < 8; ++i) {
          const std::size_t k = 8 * half + i;
          cells.data[i] = static_cast<std::uint8_t>(std::min(254, b.cell(k) / 4));
          const double mA = 1430 * b.plant().torque()[k];
          amps.data[i] = static_cast<std::uint8_t>(static_cast<int>(std::lround(mA * 127 / 240)) & 0xff);
        }
        set.push_back(cells);
        set.push_back(amps);
      }
    }
    if (temperature_ms_ > 0 && ++since_temperature_ * period_ms_ >= temperature_ms_) {
      since_temperature_ = 0;
      for (unsigned f = 0; f < 4; ++f) {
        Frame t = empty(0x38 + f, 4);
        t.data[0] = static_cast<std::uint8_t>(b.temperature());
        set.push_back(t);
      }
    }
    if (b.happens(c.faults.reorder)) std::swap(set[0], set[3]);
    for (Frame& f : set) {
      if (b.happens(c.faults.lose)) continue;
      if (b.happens(c.faults.truncate)) f.size = 5;
      queue_.push_back(f);
      if (b.happens(c.faults.duplicate)) queue_.push_back(f);
    }
  }

  /// What may go out now.
  std::deque<Frame>& outgoing() {
    const Faults& f = body_.config().faults;
    const double t = body_.plant().time();
    if (body_.past(f.silent_at)) queue_.clear();
    const bool held = f.late_at >= 0 && t >= f.late_at && t < f.late_at + f.late_for;
    return held ? nothing_ : queue_;
  }
  /// Whether it sends positions: a V5 needs its servo on for that.
  [[nodiscard]] bool talks() const {
    return period_ms_ > 0 && (body_.snapshot().servo || body_.config().generation == Generation::v4);
  }
  [[nodiscard]] int period_ms() const noexcept { return period_ms_; }
  [[nodiscard]] bool answered() const noexcept { return answered_; }

 private:
  Frame empty(unsigned message, std::uint8_t size) const {
    Frame f;
    f.id = static_cast<std::uint16_t>(message << 2 | body_.config().hand);
    f.size = size;
    return f;
  }
  Frame words(unsigned message, const std::array<int, 4>& n) const {
    Frame f = empty(message, 8);
    for (std::size_t i = 0; i < 4; ++i) {
      f.data[2 * i] = static_cast<std::uint8_t>(n[i] & 255);
      f.data[2 * i + 1] = static_cast<std::uint8_t>((n[i] >> 8) & 255);
    }
    return f;
  }
  Frame info() const {
    Frame f = empty(0x80, 7);
    const bool hot = body_.temperature() > 75;
    const int own = body_.config().generation == Generation::v4 ? 4 : 5;
    const int hardware = body_.config().hardware < 0 ? own : body_.config().hardware;
    f.data = {1,
              static_cast<std::uint8_t>(hardware),
              2,
              1,
              static_cast<std::uint8_t>(body_.config().plant.side == Side::left ? 1 : 0),
              static_cast<std::uint8_t>(body_.temperature()),
              static_cast<std::uint8_t>((body_.snapshot().servo ? 1 : 0) | (hot ? 2 : 0)),
              0};
    return f;
  }
  Frame serial() const {
    Frame f = empty(0x88, 8);
    const std::string text = body_.serial();
    for (std::size_t i = 0; i < 8; ++i) f.data[i] = static_cast<std::uint8_t>(text[i]);
    return f;
  }

  Body& body_;
  std::deque<Frame> queue_, nothing_;
  int period_ms_ = 0, temperature_ms_ = 0, since_temperature_ = 0;
  unsigned fingers_ = 0;
  bool answered_ = false;
};

}  // namespace simulated_allegro
