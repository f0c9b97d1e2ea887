#include "examples/adapters/fri/messages.hpp"

#include <algorithm>

#include "examples/adapters/protobuf.hpp"

namespace adapters::fri {
namespace {

using namespace protobuf;

std::uint32_t small(std::uint64_t x) noexcept {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(x, 0xffffffffu));
}
/// A number of an enumeration whose last value stands for those beyond it.
template <class E>
E as(std::uint64_t x, E last) noexcept {
  return static_cast<E>(std::min<std::uint64_t>(x, static_cast<std::uint64_t>(last)));
}

bool read(Bytes message, Header& out) noexcept {
  Fields f(message);
  while (f.next()) {
    if (f.is(1, number)) out.id = f.value;
    if (f.is(2, number)) out.number = static_cast<std::uint32_t>(f.value);
    if (f.is(3, number)) out.reflected = static_cast<std::uint32_t>(f.value);
  }
  return f.fine;
}
/// Joints that a message may leave out; another number of them is as none.
bool read(Bytes message, std::optional<SevenJoints>& out) noexcept {
  std::size_t count = 0;
  SevenJoints x{};
  if (!reals(message, count, x)) return false;
  if (count == joints)
    out = x;
  else
    out.reset();
  return true;
}

bool read_info(Bytes message, Monitoring& out) noexcept {
  Fields f(message);
  while (f.next()) {
    if (f.is(1, number)) out.axes = small(f.value);
    if (f.is(2, number)) out.safety = small(f.value);
    if (f.is(7, number)) out.control = as(f.value, Control::other);
  }
  return f.fine;
}
bool read_data(Bytes message, Monitoring& out, std::size_t& measured) noexcept {
  Fields f(message);
  while (f.next()) {
    if (f.wire != block) continue;
    if (f.field == 1 && (measured = 0, !reals(f.bytes, measured, out.measured))) return false;
    if (f.field == 2 && !read(f.bytes, out.measured_torque)) return false;
    if (f.field == 3 && !read(f.bytes, out.commanded)) return false;
    if (f.field == 5 && !read(f.bytes, out.external_torque)) return false;
  }
  return f.fine;
}
bool read_connection(Bytes message, Monitoring& out) noexcept {
  Fields f(message);
  while (f.next()) {
    // A state that nobody knows is none in which anything is sent; nor is its quality good.
    if (f.is(1, number)) out.session = f.value <= 4 ? static_cast<Session>(f.value) : Session::idle;
    if (f.is(2, number)) out.quality = f.value <= 3 ? static_cast<Quality>(f.value) : Quality::poor;
    if (f.is(3, number)) out.period = small(f.value);
    if (f.is(4, number)) out.multiplier = std::max<std::uint32_t>(1, small(f.value));
  }
  return f.fine;
}
bool read_motion(Bytes message, Monitoring& out) noexcept {
  Fields f(message);
  while (f.next()) {
    if (f.is(1, block) && !read(f.bytes, out.interpolated)) return false;
    if (f.is(10, number)) out.overlay = as(f.value, Overlay::other);
  }
  return f.fine;
}

void write(Writer& w, const Header& h) noexcept {
  w.message(1, [&] { w.integer(1, h.id), w.integer(2, h.number), w.integer(3, h.reflected); });
}
void write(Writer& w, std::uint32_t field, std::span<const double> x) noexcept {
  w.message(field, [&] { w.reals(x); });
}
void write(Writer& w, std::uint32_t field, const std::optional<SevenJoints>& x) noexcept {
  if (x) write(w, field, std::span<const double>(*x));
}
template <class E>
void write_state(Writer& w, std::uint32_t field, E x) noexcept {
  w.integer(field, static_cast<std::uint64_t>(x));
}

}  // namespace

bool parse(std::span<const std::uint8_t> bytes, Monitoring& out) noexcept {
  out = {};
  out.header.id = 0;
  Fields f(bytes);
  std::size_t measured = 0;
  while (f.next()) {
    if (f.wire != block) continue;
    if (f.field == 1 && !read(f.bytes, out.header)) return false;
    if (f.field == 2 && !read_info(f.bytes, out)) return false;
    if (f.field == 3 && !read_data(f.bytes, out, measured)) return false;
    if (f.field == 4 && !read_connection(f.bytes, out)) return false;
    if (f.field == 5 && !read_motion(f.bytes, out)) return false;
  }
  // One that says seven and sends six has not seven.
  if (out.axes == joints || out.axes == 0) out.axes = small(measured);
  return f.fine && out.header.id == monitoring_id && measured > 0;
}

bool parse(std::span<const std::uint8_t> bytes, Command& out) noexcept {
  out = {};
  out.header.id = 0;
  Fields f(bytes);
  while (f.next()) {
    if (f.is(1, block) && !read(f.bytes, out.header)) return false;
    if (!f.is(2, block)) continue;
    Fields data(f.bytes);
    while (data.next()) {
      if (data.is(1, block) && (out.axes = 0, !reals(data.bytes, out.axes, out.position))) return false;
      if (data.is(3, block) && !read(data.bytes, out.torque)) return false;
    }
    if (!data.fine) return false;
  }
  return f.fine && out.header.id == command_id;
}

std::size_t print(const Monitoring& m, std::span<std::uint8_t> out) noexcept {
  Writer w(out);
  const std::size_t n = std::min<std::size_t>(m.axes, joints);
  write(w, m.header);
  w.message(2, [&] {
    w.integer(1, m.axes), w.integer(2, m.safety);
    write_state(w, 7, m.control);
  });
  w.message(3, [&] {
    write(w, 1, std::span<const double>(m.measured.data(), n));
    write(w, 2, m.measured_torque), write(w, 3, m.commanded), write(w, 5, m.external_torque);
  });
  w.message(4, [&] {
    write_state(w, 1, m.session), write_state(w, 2, m.quality);
    w.integer(3, m.period), w.integer(4, m.multiplier);
  });
  w.message(5, [&] {
    write(w, 1, m.interpolated);
    write_state(w, 10, m.overlay);
  });
  return w.size();
}

std::size_t print(const Command& c, std::span<std::uint8_t> out) noexcept {
  Writer w(out);
  write(w, c.header);
  if (c.axes > 0)
    w.message(2, [&] {
      write(w, 1, std::span<const double>(c.position.data(), std::min(c.axes, joints)));
      write(w, 3, c.torque);
    });
  return w.size();
}

}  // namespace adapters::fri
