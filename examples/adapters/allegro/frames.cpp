#include "examples/adapters/allegro/frames.hpp"

namespace adapters::allegro {
namespace {

Frame frame(std::uint16_t message, unsigned hand) noexcept {
  Frame f;
  f.id = static_cast<std::uint16_t>(((unsigned{message} << 2) | (hand & 3u)) & 0x7ffu);
  return f;
}

void put(Frame& f, std::uint16_t value) noexcept {
  if (f.size > 6) return;
  f.data[f.size++] = static_cast<std::uint8_t>(value & 0xff);
  f.data[f.size++] = static_cast<std::uint8_t>(value >> 8);
}

std::uint16_t little(const Frame& f, std::size_t at) noexcept {
  return static_cast<std::uint16_t>(f.data[at] | (f.data[at + 1] << 8));
}
std::int16_t signed_little(const Frame& f, std::size_t at) noexcept {
  return static_cast<std::int16_t>(little(f, at));
}

Message info(const Frame& f) noexcept {
  if (f.size < 7) return Unknown{};
  return Info{little(f, 0), little(f, 2), f.data[4] == 0 ? Side::right : Side::left, f.data[5], f.data[6]};
}

Message serial(const Frame& f) noexcept {
  if (f.size != 8) return Unknown{};
  Serial s;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::uint8_t c = f.data[i];
    s.text[i] = c >= 0x20 && c < 0x7f ? static_cast<char>(c) : '?';  // it will be printed
  }
  return s;
}

Message tactile(const Frame& f, unsigned place, TactileFrames layout) noexcept {
  if (f.size != 8 || (layout == TactileFrames::two && place > 1)) return Unknown{};
  Tactile t;
  t.count = layout == TactileFrames::two ? 8 : 4;
  t.first = static_cast<std::uint8_t>(t.count * place);
  for (std::size_t i = 0; i < t.count; ++i) {
    if (layout == TactileFrames::two) {
      t.reading[i] = f.data[i] == 0xff ? std::uint16_t(0) : static_cast<std::uint16_t>(f.data[i] << 2);
    } else {
      const auto x = static_cast<std::uint16_t>((f.data[2 * i] << 8) | f.data[2 * i + 1]);
      t.reading[i] = x > 0x7fff ? std::uint16_t(0) : x;
    }
  }
  return t;
}

Message currents(const Frame& f, unsigned place) noexcept {
  if (f.size != 8 || (place != 0 && place != 3)) return Unknown{};
  Currents c;
  c.first = place == 0 ? 0 : 8;
  for (std::size_t i = 0; i < 8; ++i) c.milliampere[i] = static_cast<std::int8_t>(f.data[i]) * 240.0 / 127.0;
  return c;
}

}  // namespace

Frame servo(bool on, unsigned hand) noexcept {
  return frame(on ? message::servo_on : message::servo_off, hand);
}
Frame request(std::uint16_t what, unsigned hand) noexcept {
  Frame f = frame(what, hand);
  f.remote = true;
  return f;
}
Frame period(std::uint16_t position_ms, std::uint16_t imu_ms, std::uint16_t temperature_ms,
             unsigned hand) noexcept {
  Frame f = frame(message::period, hand);
  put(f, position_ms);
  put(f, imu_ms);
  put(f, temperature_ms);
  return f;
}
Frame torque(unsigned finger, const std::array<std::int16_t, 4>& value, unsigned hand) noexcept {
  Frame f = frame(static_cast<std::uint16_t>(message::torque + (finger & 3u)), hand);
  for (const std::int16_t x : value) put(f, static_cast<std::uint16_t>(x));
  return f;
}

Message decode(const Frame& f, Generation generation, unsigned hand, TactileFrames layout) noexcept {
  if (f.remote || f.size > 8 || f.id > 0x7ff || (f.id & 3u) != (hand & 3u)) return Unknown{};
  const std::uint16_t m = message_of(f);
  const unsigned place = m & 3u;
  if (m == message::info) return info(f);
  if (m == message::serial) return serial(f);
  if ((m & ~3u) == message::position) {
    if (f.size != 8) return Unknown{};
    return Positions{static_cast<std::uint8_t>(place),
                     {signed_little(f, 0), signed_little(f, 2), signed_little(f, 4), signed_little(f, 6)}};
  }
  if (m == message::imu) {
    if (f.size < 6) return Unknown{};
    return Orientation{{little(f, 0), little(f, 2), little(f, 4)}};
  }
  if ((m & ~3u) == message::temperature) {
    if (f.size < 4) return Unknown{};
    const std::uint32_t celsius = little(f, 0) | static_cast<std::uint32_t>(little(f, 2)) << 16;
    return Temperature{static_cast<std::uint8_t>(place), static_cast<std::int32_t>(celsius)};
  }
  if (generation == Generation::v5_sense) {
    if ((m & ~3u) == message::tactile) return tactile(f, place, layout);
    if ((m & ~3u) == message::current) return currents(f, place);
  }
  return Unknown{};
}

TorqueScale TorqueScale::of(Generation generation, double full_torque, Gears gears) noexcept {
  constexpr std::array<std::int16_t, 4> finger = {375, 675, 450, 285}, thumb = {525, 405, 270, 270};
  TorqueScale s;
  for (std::size_t i = 0; i < 16; ++i) {
    if (generation == Generation::v4) {
      s.per_newton_metre[i] = 1200 / full_torque;
      s.cap[i] = i < 12 ? finger[i % 4] : thumb[i % 4];
    } else {
      const Gears own = i == 1 || i == 5 || i == 9 ? gears : Gears::plain;
      s.per_newton_metre[i] = own == Gears::plain ? 1430 : 715;
      s.cap[i] = own == Gears::unknown ? 120 : 240;
    }
  }
  return s;
}

skinctl::JointTorque<16> TorqueScale::limit() const noexcept {
  return skinctl::JointTorque<16>::generate([&](std::size_t i) { return cap[i] / per_newton_metre[i]; });
}

std::array<std::int16_t, 16> TorqueScale::encode(const skinctl::JointTorque<16>& tau) const noexcept {
  std::array<std::int16_t, 16> out{};
  for (std::size_t i = 0; i < 16; ++i) {
    const double x = tau[i] * per_newton_metre[i], most = cap[i];
    if (!(x == x)) continue;
    out[i] = static_cast<std::int16_t>(x > most ? most : x < -most ? -most : x);
  }
  return out;
}

}  // namespace adapters::allegro
