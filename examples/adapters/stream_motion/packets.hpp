// Packets of FANUC's stream motion (option J519): big-endian, packed, one datagram each.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace adapters::stream_motion {

namespace type {
inline constexpr std::uint32_t stop = 2, limits = 3, get_capability = 7, start = 200, command = 201,
                               status_3 = 202, status_4 = 204;
}
inline constexpr std::uint16_t joint_style = 0xffff;  ///< of a command whose numbers are joints, not a pose
inline constexpr std::size_t max_bytes = 512;

/// Start and stop are no more than this.
struct Header {
  std::uint32_t type = 0, version = 3;
};
struct Capability {
  Header header{type::get_capability};
  std::uint32_t id = 1;
  std::uint32_t sampling = 0;    ///< period [ms]
  std::uint32_t start_move = 0;  ///< commands that wait before motion begins
  std::uint32_t available = 0;   ///< newest version
  std::uint32_t use_tool = 0;    ///< whether the streamed pose is that of the tool
};
struct Command {
  Header header{type::command};
  std::uint32_t sequence = 0;
  std::uint8_t last = 0, moves = 1;
  std::uint16_t style = joint_style;
  std::array<double, 9> joints{};  ///< [deg]
  std::array<std::uint8_t, 256> io{};
};
struct Status {
  static constexpr std::uint8_t ready = 1, received = 2, system_ready = 4, moving = 8;  // of `status`
  static constexpr std::uint8_t error = 1, pendant = 2, emergency_stop = 4;             // of `robot`
  Header header{type::status_3};
  std::uint32_t sequence = 0;
  std::uint8_t status = 0, robot = 0, contact_stop = 0, unused = 0;
  std::uint32_t milliseconds = 0;
  std::array<float, 9> pose{}, joints{}, current{};  ///< of the flange [mm], [deg]; [deg]; [A]
  float safety_scale = 1;
  std::array<float, 6> force{};  ///< version 4 [N], [N m]
  std::uint32_t sensor = 0;      ///< version 4: 0 none, 1 embedded, 2 external
  std::array<std::uint8_t, 256> io{};
};
struct LimitsQuestion {
  Header header{type::limits};
  std::uint32_t axis = 1, kind = 0;  ///< 1 to 9; 0 velocity, 1 acceleration, 2 jerk
};
/// Largest magnitudes over the speed of the tool, in 20 steps up to `max_speed`.
struct Limits {
  Header header{type::limits};
  std::uint32_t axis = 0, kind = 0, max_speed = 0, interval = 0;
  std::array<float, 20> empty{}, loaded{};  ///< [deg/s], [deg/s^2], [deg/s^3]
};

// The layout of each, for both directions.
template <class Bytes>
void fields(Bytes& b, Header& h) {
  b(h.type), b(h.version);
}
template <class Bytes>
void fields(Bytes& b, Capability& c) {
  fields(b, c.header), b(c.id), b(c.sampling), b(c.start_move), b(c.available), b(c.use_tool);
}
template <class Bytes>
void fields(Bytes& b, Command& c) {
  fields(b, c.header), b(c.sequence), b(c.last), b(c.moves), b(c.style), b(c.joints), b(c.io);
}
template <class Bytes>
void fields(Bytes& b, Status& s) {
  fields(b, s.header), b(s.sequence), b(s.status), b(s.robot), b(s.contact_stop), b(s.unused);
  b(s.milliseconds), b(s.pose), b(s.joints), b(s.current), b(s.safety_scale);
  if (s.header.type == type::status_4) b(s.force), b(s.sensor);
  b(s.io);
}
template <class Bytes>
void fields(Bytes& b, LimitsQuestion& q) {
  fields(b, q.header), b(q.axis), b(q.kind);
}
template <class Bytes>
void fields(Bytes& b, Limits& l) {
  fields(b, l.header), b(l.axis), b(l.kind), b(l.max_speed), b(l.interval), b(l.empty), b(l.loaded);
}

namespace detail {
template <class N>
auto bits(N x) noexcept {
  if constexpr (sizeof(N) == 8)
    return std::bit_cast<std::uint64_t>(x);
  else if constexpr (sizeof(N) == 4)
    return std::bit_cast<std::uint32_t>(x);
  else
    return x;
}
/// Reads or writes numbers one after another; past the end it stops, and `ok` is false.
template <class Byte>
struct Cursor {
  std::span<Byte> bytes;
  std::size_t at = 0;
  bool ok = true;

  template <class N>
  void operator()(N& x) {
    if (!(ok = ok && bytes.size() - at >= sizeof(N))) return;
    auto raw = bits(x);
    using Raw = decltype(raw);
    if constexpr (std::is_const_v<Byte>) {
      std::uint64_t all = 0;
      for (std::size_t i = 0; i < sizeof(N); ++i) all = all << 8 | bytes[at++];
      x = std::bit_cast<N>(static_cast<Raw>(all));
    } else {
      for (std::size_t i = sizeof(N); i-- > 0;)
        bytes[at++] = static_cast<Byte>(std::uint64_t{raw} >> (8 * i));
    }
  }
  template <class N, std::size_t K>
  void operator()(std::array<N, K>& x) {
    for (N& one : x) (*this)(one);
  }
};
}  // namespace detail

/// False unless these bytes are exactly such a packet, by length and type.
template <class Packet>
bool parse(std::span<const std::uint8_t> bytes, Packet& out) noexcept {
  const Packet expected = out = {};
  detail::Cursor<const std::uint8_t> cursor{bytes};
  fields(cursor, out);
  std::uint32_t is = 0, should = 0;
  if constexpr (std::is_same_v<Packet, Header>)
    return cursor.ok && cursor.at == bytes.size();
  else
    is = out.header.type, should = expected.header.type;
  const bool newer = std::is_same_v<Packet, Status> && is == type::status_4;
  return cursor.ok && cursor.at == bytes.size() && (is == should || newer);
}
/// The number of bytes written; 0: there was no room.
template <class Packet>
std::size_t print(Packet packet, std::span<std::uint8_t> to) noexcept {
  detail::Cursor<std::uint8_t> cursor{to};
  fields(cursor, packet);
  return cursor.ok ? cursor.at : 0;
}

}  // namespace adapters::stream_motion
