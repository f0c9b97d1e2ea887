// Protobuf on the wire, as far as the messages of robots need it: fields to read, fields to write, no
// descriptor.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace adapters::protobuf {

using Bytes = std::span<const std::uint8_t>;
/// How a field is written.
enum Wire : std::uint32_t { number = 0, eight_bytes = 1, block = 2, four_bytes = 5 };

inline double real(Bytes b) noexcept {
  std::uint64_t x = 0;
  for (std::size_t k = b.size(); k-- > 0;) x = x << 8 | b[k];
  return std::bit_cast<double>(x);
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

/// The doubles of field 1, one by one or packed: how many, of which the first N are kept. False: not finite,
/// or no message.
template <std::size_t N>
bool reals(Bytes message, std::size_t& count, std::array<double, N>& out) noexcept {
  Fields f(message);
  const auto add = [&](Bytes b) {
    const double x = real(b);
    if (count < N) out[count] = x;
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
/// What is in field 1 of a message.
template <std::size_t N>
bool reals_within(Bytes message, std::size_t& count, std::array<double, N>& out) noexcept {
  Fields f(message);
  count = 0;
  while (f.next())
    if (f.is(1, block) && !reals(f.bytes, count, out)) return false;
  return f.fine;
}

/// Writes fields into a buffer.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> out) noexcept : out_(out) {}
  void integer(std::uint32_t field, std::uint64_t x) noexcept { varint(field << 3 | number), varint(x); }
  /// A message in a field, which `write` writes.
  template <class Write>
  void message(std::uint32_t field, const Write& write) noexcept {
    varint(field << 3 | block);
    const std::size_t at = size_;
    byte(0);
    write();
    std::size_t length = size_ - at - 1;
    // Its length stands before it, in one byte for each 7 bits.
    for (std::size_t x = length >> 7; x > 0 && fine_; x >>= 7) {
      byte(0);
      for (std::size_t k = size_ - 1; fine_ && k > at; --k) out_[k] = out_[k - 1];
    }
    for (std::size_t k = at; fine_; ++k, length >>= 7) {
      out_[k] = static_cast<std::uint8_t>((length & 0x7f) | (length > 0x7f ? 0x80 : 0));
      if (length <= 0x7f) break;
    }
  }
  /// Doubles in field 1, each with its key.
  void reals(std::span<const double> x) noexcept {
    for (const double v : x) {
      varint(1u << 3 | eight_bytes);
      const auto bits = std::bit_cast<std::uint64_t>(v);
      for (unsigned k = 0; k < 8; ++k) byte(static_cast<std::uint8_t>(bits >> (8 * k)));
    }
  }
  /// The size of what was written; 0: there was no room.
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

}  // namespace adapters::protobuf
