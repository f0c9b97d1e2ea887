// SPDX-License-Identifier: BSD-3-Clause
// CDR: the bytes of a ROS 2 or DDS message.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ranges>
#include <span>
#include <string_view>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A type that CDR knows as a number of 1, 2, 4 or 8 bytes.
template <class V>
concept CdrNumber = std::is_arithmetic_v<V> && !std::same_as<V, long double> && sizeof(V) <= 8;

static_assert(std::endian::native == std::endian::little, "messages are written little-endian, as they lie");

/// Bytes before the first member: representation (0, 1: plain CDR, little-endian) and options.
inline constexpr std::size_t cdr_header_size = 4;

/// Writes a message in XCDR1, little-endian (OMG DDSI-RTPS 2.3, 10), into bytes that are given: nothing is
/// allocated.
///
/// A member is aligned to its own size, counted from behind the header; padding is zero. Behind the end
/// nothing is written, but counted: `fits()` says whether the message is whole, `size()` how many bytes it
/// takes.
class CdrWriter {
 public:
  explicit CdrWriter(std::span<unsigned char> bytes) noexcept : bytes_(bytes) {
    constexpr unsigned char header[cdr_header_size] = {0, 1, 0, 0};
    append(header, sizeof header);
  }

  template <CdrNumber V>
  void put(V value) noexcept {
    align(sizeof value);
    if constexpr (std::same_as<V, bool>) {
      const unsigned char byte = value ? 1 : 0;
      append(&byte, 1);
    } else {
      append(&value, sizeof value);
    }
  }
  /// Writes a string: its length with the closing NUL, its bytes, the NUL.
  void put(std::string_view text) noexcept {
    put(static_cast<std::uint32_t>(text.size() + 1));
    append(text.data(), text.size());
    append("", 1);
  }
  /// Writes the number of elements of a sequence that follows, element by element.
  void count(std::size_t n) noexcept { put(static_cast<std::uint32_t>(n)); }
  /// Writes a sequence of numbers. An empty one has no padding behind its count.
  template <std::ranges::contiguous_range R>
    requires CdrNumber<std::ranges::range_value_t<R>>
  void sequence(const R& values) noexcept {
    count(std::ranges::size(values));
    array(values);
  }
  /// Writes numbers one after another without a count: a part of a sequence, or an array.
  template <std::ranges::contiguous_range R>
    requires CdrNumber<std::ranges::range_value_t<R>>
  void array(const R& values) noexcept {
    constexpr std::size_t size = sizeof(std::ranges::range_value_t<R>);
    if (std::ranges::empty(values)) return;
    align(size);
    append(std::ranges::data(values), size * std::ranges::size(values));
  }
  /// Writes zeros up to the next multiple of `size`, which is 1, 2, 4 or 8.
  void align(std::size_t size) noexcept {
    constexpr unsigned char zeros[8] = {};
    append(zeros, (0 - (size_ - cdr_header_size)) & (size - 1));
  }

  /// Whether the whole message fits into the bytes.
  [[nodiscard]] bool fits() const noexcept { return size_ <= bytes_.size(); }
  /// Number of bytes of the message, also of one that does not fit.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// The message; empty if it does not fit.
  [[nodiscard]] std::span<const unsigned char> bytes() const noexcept {
    return fits() ? std::span<const unsigned char>(bytes_.first(size_)) : std::span<const unsigned char>();
  }

 private:
  void append(const void* data, std::size_t n) noexcept {
    if (n != 0 && size_ <= bytes_.size() && n <= bytes_.size() - size_)
      std::memcpy(bytes_.data() + size_, data, n);
    else if (n != 0)
      bytes_ = bytes_.first(size_ < bytes_.size() ? size_ : bytes_.size());
    size_ += n;
  }

  std::span<unsigned char>
      bytes_;  // shortened at the first member that does not fit, so that none follows it
  std::size_t size_ = 0;
};

/// Reads a message from bytes that nobody vouches for.
///
/// Past the end, and after a text or sequence that cannot be, everything read is zero or empty and `fits()`
/// is false. Only plain little-endian CDR is read: another header does not fit. Bytes behind the last member
/// are no error: a sender may pad a message to a multiple of 4.
class CdrReader {
 public:
  explicit CdrReader(std::span<const unsigned char> bytes) noexcept : bytes_(bytes) {
    fits_ = bytes.size() >= cdr_header_size && bytes[0] == 0 && bytes[1] == 1;
    at_ = fits_ ? cdr_header_size : bytes.size();
  }

  template <CdrNumber V>
  [[nodiscard]] V get() noexcept {
    V value{};
    align(sizeof value);
    const auto bytes = take(sizeof value);
    if (bytes.empty()) return value;
    if constexpr (std::same_as<V, bool>) {
      value = bytes[0] != 0;
    } else {
      std::memcpy(&value, bytes.data(), sizeof value);
    }
    return value;
  }
  /// Reads a string, without its NUL. The view refers to the message.
  [[nodiscard]] std::string_view text() noexcept {
    const std::size_t n = get<std::uint32_t>();
    if (n == 0) return {};  // some senders write an empty string so
    const auto bytes = take(n);
    if (bytes.empty()) return {};
    if (bytes.back() != 0) {
      fail();
      return {};
    }
    return {reinterpret_cast<const char*>(bytes.data()), n - 1};
  }
  /// Reads the number of elements of a sequence, each of at least `least` bytes: a count for which the
  /// message has too few bytes does not fit, so that nobody makes room for it.
  [[nodiscard]] std::size_t count(std::size_t least) noexcept {
    const std::size_t n = get<std::uint32_t>();
    if (n <= left() / (least > 0 ? least : 1)) return n;
    fail();
    return 0;
  }
  /// Takes the next `n` bytes as they lie; empty if there are not as many.
  [[nodiscard]] std::span<const unsigned char> take(std::size_t n) noexcept {
    if (n > left()) {
      fail();
      return {};
    }
    const auto out = bytes_.subspan(at_, n);
    at_ += n;
    return out;
  }
  /// Skips padding in front of a member of `size` bytes: 1, 2, 4 or 8.
  void align(std::size_t size) noexcept {
    if (!fits_) return;
    static_cast<void>(take((0 - (at_ - cdr_header_size)) & (size - 1)));
  }
  /// Whether every member so far was there.
  [[nodiscard]] bool fits() const noexcept { return fits_; }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }

 private:
  void fail() noexcept {
    fits_ = false;
    at_ = bytes_.size();
  }

  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
  bool fits_ = false;
};

SKINCTL_END_NAMESPACE
