#include "examples/adapters/egm/messages.hpp"

#include <bit>
#include <cmath>

namespace adapters::egm {
namespace {

using Bytes = std::span<const std::uint8_t>;
enum Wire : std::uint32_t { number = 0, eight_bytes = 1, block = 2, four_bytes = 5 };
enum Type : std::uint32_t { data = 2, correction = 3 };  // of a header

std::uint64_t little(Bytes b) noexcept {
  std::uint64_t x = 0;
  for (std::size_t k = b.size(); k-- > 0;) x = x << 8 | b[k];
  return x;
}
double real(Bytes b) noexcept {
  return std::bit_cast<double>(little(b));
}

/// One field after the other of a protobuf message.
class Fields {
 public:
  explicit Fields(Bytes message) noexcept : rest_(message) {}
  /// False: the end, or bytes that are no field; then `fine` is false.
  bool next() noexcept {
    std::uint64_t key = 0;
    if (rest_.empty() || !varint(key)) return false;
    field = static_cast<std::uint32_t>(key >> 3), wire = static_cast<std::uint32_t>(key & 7);
    if (key >> 3 == 0 || key >> 32 != 0) return fine = false;
    switch (wire) {
      case number:
        return varint(value);
      case eight_bytes:
        return take(8);
      case four_bytes:
        return take(4);
      case block:
        return varint(value) && take(value);
      default:
        return fine = false;
    }
  }
  [[nodiscard]] bool is(std::uint32_t f, std::uint32_t w) const noexcept { return field == f && wire == w; }

  std::uint32_t field = 0, wire = 0;
  std::uint64_t value = 0;  ///< of a number
  Bytes bytes;              ///< of the others
  bool fine = true;

 private:
  bool varint(std::uint64_t& out) noexcept {
    out = 0;
    for (std::size_t k = 0; k < 10 && k < rest_.size(); ++k) {
      out |= static_cast<std::uint64_t>(rest_[k] & 0x7f) << (7 * k);
      if (rest_[k] < 0x80) {
        rest_ = rest_.subspan(k + 1);
        return true;
      }
    }
    return fine = false;
  }
  bool take(std::uint64_t size) noexcept {
    if (size > rest_.size()) return fine = false;
    bytes = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(static_cast<std::size_t>(size));
    return true;
  }
  Bytes rest_;
};

/// The doubles of field 1, one by one or packed: how many, of which six are kept. False: not finite, or no message.
bool reals(Bytes message, std::size_t& count, std::array<double, 6>& out) noexcept {
  Fields f(message);
  const auto add = [&](Bytes b) {
    const double x = real(b);
    if (count < 6) out[count] = x;
    ++count;
    return std::isfinite(x);
  };
  while (f.next()) {
    if (f.is(1, eight_bytes) && !add(f.bytes)) return false;
    if (!f.is(1, block)) continue;
    if (f.bytes.size() % 8 != 0) return false;
    for (std::size_t k = 0; k < f.bytes.size(); k += 8)
      if (!add(f.bytes.subspan(k, 8))) return false;
  }
  return f.fine;
}
/// The joints of a planned or measured pose.
bool joints(Bytes message, std::size_t& count, std::array<double, 6>& out) noexcept {
  Fields f(message);
  count = 0;
  while (f.next())
    if (f.is(1, block) && !reals(f.bytes, count, out)) return false;
  return f.fine;
}
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

class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> out) noexcept : out_(out) {}
  void integer(std::uint32_t field, std::uint64_t x) noexcept { varint(field << 3 | number), varint(x); }
  /// A message in a field, which `write` writes; it is shorter than 128 bytes.
  template <class Write>
  void message(std::uint32_t field, const Write& write) noexcept {
    varint(field << 3 | block);
    const std::size_t at = size_;
    byte(0);
    write();
    const std::size_t length = size_ - at - 1;
    if (length >= 128) fine_ = false;
    if (fine_) out_[at] = static_cast<std::uint8_t>(length);
  }
  void reals(std::span<const double> x) noexcept {
    for (const double v : x) {
      varint(1u << 3 | eight_bytes);
      const auto bits = std::bit_cast<std::uint64_t>(v);
      for (unsigned k = 0; k < 8; ++k) byte(static_cast<std::uint8_t>(bits >> (8 * k)));
    }
  }
  [[nodiscard]] std::size_t size() const noexcept { return fine_ ? size_ : 0; }

 private:
  void byte(std::uint8_t b) noexcept {
    if (size_ < out_.size())
      out_[size_++] = b;
    else
      fine_ = false;
  }
  void varint(std::uint64_t x) noexcept {
    for (; x >= 0x80; x >>= 7) byte(static_cast<std::uint8_t>(x | 0x80));
    byte(static_cast<std::uint8_t>(x));
  }
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
  bool fine_ = true;
};
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
        if (!joints(f.bytes, out.joints, out.feedback)) return false;
        break;
      case 3:
        if (!joints(f.bytes, planned, out.planned)) return false;
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
    if (f.is(2, block) && !joints(f.bytes, out.joints, out.planned)) return false;
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
