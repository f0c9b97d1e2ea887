// A program's sockets.
#include <algorithm>

#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

constexpr const char* default_name = "socket_0";
constexpr std::size_t most_numbers = 255;

Outcome open(Call& c) {
  const std::string name = c.text(2, default_name);
  if (c.first) {
    c.robot.sockets.close(name);
    const double port = c.number(1, 0);
    if (!(port >= 1 && port <= 65535)) return c.give(false);
    if (!c.robot.sockets.open(name, c.text(0), static_cast<std::uint16_t>(port))) return c.give(false);
  }
  const auto socket = c.robot.sockets.find(name);
  if (!socket) return c.give(false);
  if (socket->state == Socket::State::wanted) return Outcome::again;
  if (socket->state == Socket::State::open) return c.give(true);
  c.robot.sockets.close(name);
  return c.give(false);
}

Outcome close(Call& c) {
  c.robot.sockets.close(c.text(0, default_name));
  return Outcome::done;
}

Outcome send(Call& c, std::size_t name, const std::vector<std::uint8_t>& bytes) {
  const auto socket = c.robot.sockets.find(c.text(name, default_name));
  if (!socket || socket->state != Socket::State::open || socket->peer_gone ||
      socket->to_send.size() + bytes.size() > Sockets::longest_queue)
    return c.give(false);
  socket->to_send.insert(socket->to_send.end(), bytes.begin(), bytes.end());
  return c.give(true);
}
Outcome send_text(Call& c, const char* behind) {
  const std::string s = c[0].text() + behind;
  return send(c, 1, {s.begin(), s.end()});
}
Outcome send_integer(Call& c) {
  const auto v = static_cast<std::uint32_t>(
      static_cast<std::int64_t>(std::clamp(c.number(0, 0), -2147483648.0, 4294967295.0)));
  return send(c, 1,
              {static_cast<std::uint8_t>(v >> 24), static_cast<std::uint8_t>(v >> 16),
               static_cast<std::uint8_t>(v >> 8), static_cast<std::uint8_t>(v)});
}
Outcome send_byte(Call& c) {
  return send(c, 1,
              {static_cast<std::uint8_t>(static_cast<std::int64_t>(std::clamp(c.number(0, 0), 0.0, 255.0)))});
}

/// True when a read has waited long enough; a time-out of 0 or less waits for ever.
bool timed_out(const Call& c, double timeout) {
  return timeout > 0 && seconds(c.robot.now - c.since) >= timeout - 1e-9;
}

/// [count, number 1, ...]; [0] after a time-out or when the peer has gone.
Outcome read_integers(Call& c) {
  const double wanted = c.number(0, 0), timeout = c.number(2, 2);
  if (!(wanted >= 1 && wanted <= static_cast<double>(most_numbers)))
    return c.fail("runtime_error_argument:number:");
  const auto count = static_cast<std::size_t>(wanted);
  const auto socket = c.robot.sockets.find(c.text(1, default_name));
  const bool there = socket && socket->received.size() >= 4 * count;
  if (!there) {
    if (socket && !socket->peer_gone && !timed_out(c, timeout)) return Outcome::again;
    std::vector<Value> nothing(count + 1, Value(0));
    return c.give(*list_of(std::move(nothing)));
  }
  std::vector<Value> out{Value(static_cast<std::int64_t>(count))};
  const auto& bytes = socket->received;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 4; ++k) v = v << 8 | bytes[4 * i + k];
    out.emplace_back(static_cast<std::int64_t>(static_cast<std::int32_t>(v)));
  }
  socket->received.erase(socket->received.begin(),
                         socket->received.begin() + static_cast<std::ptrdiff_t>(4 * count));
  return c.give(*list_of(std::move(out)));
}

/// Text up to a line's end, or what there is after a time-out.
Outcome read_text(Call& c, std::size_t name, double timeout) {
  const auto socket = c.robot.sockets.find(c.text(name, default_name));
  if (!socket) return c.give(Value(""));
  auto& bytes = socket->received;
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{'\n'});
  if (end == bytes.end() && !socket->peer_gone && !timed_out(c, timeout)) return Outcome::again;
  const std::string s(bytes.begin(), end);
  bytes.erase(bytes.begin(), end == bytes.end() ? end : end + 1);
  return c.give(Value(s.substr(0, longest_string)));
}

constexpr Builtin socket_table[] = {
    {"socket_open", "address port socket_name", open, true},
    {"socket_close", "socket_name", close},
    {"socket_send_string", "str socket_name", [](Call& c) { return send_text(c, ""); }},
    {"socket_send_line", "str socket_name", [](Call& c) { return send_text(c, "\n"); }},
    {"socket_send_int", "value socket_name", send_integer},
    {"socket_send_byte", "value socket_name", send_byte},
    {"socket_read_binary_integer", "number socket_name timeout", read_integers, true},
    {"socket_read_line", "socket_name timeout", [](Call& c) { return read_text(c, 0, c.number(1, 2)); },
     true},
    {"socket_read_string", "socket_name prefix suffix interpret_escape timeout",
     [](Call& c) { return read_text(c, 0, c.number(4, 2)); }, true},
};

}  // namespace

std::span<const Builtin> socket_functions() {
  return socket_table;
}

}  // namespace simulated_ur5::urscript
