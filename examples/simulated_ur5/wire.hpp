// Bytes as Universal Robots writes them: big-endian and unaligned, every read checked against the end.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace simulated_ur5 {

/// Appends big-endian numbers to a buffer.
class BigEndianWriter {
 public:
  explicit BigEndianWriter(std::vector<std::uint8_t>& out) : out_(out) {}

  void u8(std::uint8_t v) { out_.push_back(v); }
  void u16(std::uint16_t v) { number(v, 2); }
  void u32(std::uint32_t v) { number(v, 4); }
  void u64(std::uint64_t v) { number(v, 8); }
  void i32(std::int32_t v) { u32(static_cast<std::uint32_t>(v)); }
  void f32(float v) { u32(std::bit_cast<std::uint32_t>(v)); }
  void f64(double v) { u64(std::bit_cast<std::uint64_t>(v)); }
  void text(std::string_view v) {
    for (char c : v) out_.push_back(static_cast<std::uint8_t>(c));
  }

 private:
  void number(std::uint64_t v, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) out_.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
  }
  std::vector<std::uint8_t>& out_;
};

/// Takes big-endian numbers from bytes; past the end it gives zeros and `ok()` turns false for good.
class BigEndianReader {
 public:
  explicit BigEndianReader(std::span<const std::uint8_t> in) : in_(in) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  std::span<const std::uint8_t> rest() {
    const auto r = in_.subspan(at_);
    at_ = in_.size();
    return r;
  }
  std::size_t left() const { return in_.size() - at_; }
  bool ok() const { return ok_; }

 private:
  std::uint64_t number(std::size_t bytes) {
    if (left() < bytes) {
      ok_ = false;
      at_ = in_.size();
      return 0;
    }
    std::uint64_t v = 0;
    for (std::size_t i = 0; i < bytes; ++i) v = v << 8 | in_[at_++];
    return v;
  }
  std::span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace simulated_ur5
