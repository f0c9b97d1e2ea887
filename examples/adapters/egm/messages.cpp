#include "examples/adapters/egm/messages.hpp"

#include "examples/adapters/protobuf.hpp"

namespace adapters::egm {
namespace {

using namespace protobuf;
enum Type : std::uint32_t { data = 2, correction = 3 };  // of a header

bool header(Bytes message, std::uint32_t& number_of, std::uint32_t& time) noexcept {
  Fields f(message);
  while (f.next()) {
    if (f.is(1, number)) number_of = static_cast<std::uint32_t>(f.value);
    if (f.is(2, number)) time = static_cast<std::uint32_t>(f.value);
  }
  return f.fine;
}
/// The number in field 1 of a message; above `most` it is unknown.
bool state(Bytes message, std::uint64_t most, std::uint64_t& out) noexcept {
  Fields f(message);
  while (f.next())
    if (f.is(1, number)) out = f.value <= most ? f.value : 0;
  return f.fine;
}

void write_header(Writer& w, std::uint32_t number_of, std::uint32_t time, Type type) noexcept {
  w.message(1, [&] { w.integer(1, number_of), w.integer(2, time), w.integer(3, type); });
}
void write_joints(Writer& w, std::uint32_t field, std::span<const double> x) noexcept {
  w.message(field, [&] { w.message(1, [&] { w.reals(x); }); });
}

}  // namespace

bool parse(std::span<const std::uint8_t> bytes, RobotMessage& out) noexcept {
  out = {};
  Fields f(bytes);
  bool has_header = false;
  std::size_t planned = 0, forces = 0;
  while (f.next()) {
    if (f.wire != block) continue;
    std::uint64_t x = 0;
    switch (f.field) {
      case 1:
        if (!header(f.bytes, out.number, out.time)) return false;
        has_header = true;
        break;
      case 2:
        if (!reals_within(f.bytes, out.joints, out.feedback)) return false;
        break;
      case 3:
        if (!reals_within(f.bytes, planned, out.planned)) return false;
        break;
      case 4:
        if (!state(f.bytes, 2, x)) return false;
        out.motors = static_cast<Motors>(x);
        break;
      case 5:
        if (!state(f.bytes, 3, x)) return false;
        out.guided = static_cast<Guided>(x);
        break;
      case 8:
        if (!state(f.bytes, 2, x)) return false;
        out.rapid = static_cast<Rapid>(x);
        break;
      case 9:
        forces = 0;
        if (!reals(f.bytes, forces, out.force)) return false;
        break;
      default:
        break;
    }
  }
  out.has_planned = planned == 6, out.has_force = forces == 6;
  return f.fine && has_header && out.joints > 0;
}

bool parse(std::span<const std::uint8_t> bytes, SensorMessage& out) noexcept {
  out = {};
  Fields f(bytes);
  bool has_header = false;
  while (f.next()) {
    if (f.is(1, block)) {
      if (!header(f.bytes, out.number, out.time)) return false;
      has_header = true;
    }
    if (f.is(2, block) && !reals_within(f.bytes, out.joints, out.planned)) return false;
  }
  return f.fine && has_header && out.joints > 0;
}

std::size_t print(const RobotMessage& m, std::span<std::uint8_t> out) noexcept {
  Writer w(out);
  const std::size_t n = m.joints < 6 ? m.joints : 6;
  write_header(w, m.number, m.time, data);
  write_joints(w, 2, {m.feedback.data(), n});
  if (m.has_planned) write_joints(w, 3, {m.planned.data(), n});
  const auto said = [&](std::uint32_t field, auto x) {
    if (static_cast<unsigned>(x) != 0) w.message(field, [&] { w.integer(1, static_cast<unsigned>(x)); });
  };
  said(4, m.motors), said(5, m.guided), said(8, m.rapid);
  if (m.has_force) w.message(9, [&] { w.reals(m.force); });
  return w.size();
}

std::size_t print(const SensorMessage& m, std::span<std::uint8_t> out) noexcept {
  Writer w(out);
  write_header(w, m.number, m.time, correction);
  write_joints(w, 2, {m.planned.data(), m.joints < 6 ? m.joints : 6});
  return w.size();
}

}  // namespace adapters::egm
