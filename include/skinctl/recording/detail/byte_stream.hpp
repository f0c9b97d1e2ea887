// SPDX-License-Identifier: BSD-3-Clause
// Plain values as bytes, and back.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Appends plain values to bytes reserved before: never allocates.
class ByteWriter {
 public:
  explicit ByteWriter(std::size_t capacity) { bytes_.reserve(capacity); }
  [[nodiscard]] bool fits(std::size_t n) const noexcept { return bytes_.capacity() - bytes_.size() >= n; }
  template <class V>
  void put(const V& value) noexcept {
    static_assert(std::is_arithmetic_v<V>);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);  // within the capacity, else the record is dropped: see `fits`
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  [[nodiscard]] const std::vector<unsigned char>& bytes() const noexcept { return bytes_; }
  void clear() noexcept { bytes_.clear(); }
  void put(const void* data, std::size_t n) noexcept {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + n);
    std::memcpy(bytes_.data() + at, data, n);
  }

 private:
  std::vector<unsigned char> bytes_;
};

/// Reads plain values from bytes; past the end it gives zeros and sets a flag.
class ByteReader {
 public:
  explicit ByteReader(std::span<const unsigned char> bytes) noexcept : bytes_(bytes) {}
  template <class V>
  V get() noexcept {
    static_assert(std::is_arithmetic_v<V>);
    V value{};
    if (bytes_.size() - at_ < sizeof value) {
      short_ = true;
      at_ = bytes_.size();
      return value;
    }
    if constexpr (std::is_same_v<V, bool>) {
      value = bytes_[at_] != 0;
    } else {
      std::memcpy(&value, bytes_.data() + at_, sizeof value);
    }
    at_ += sizeof value;
    return value;
  }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }
  [[nodiscard]] bool short_of_bytes() const noexcept { return short_; }

 private:
  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
  bool short_ = false;
};

/// Writes plain values one after another where there is room for all of them: whoever gave the place has
/// counted.
class BytePlace {
 public:
  explicit BytePlace(unsigned char* at) noexcept : begin_(at), at_(at) {}
  template <class V>
  SKINCTL_INLINE void put(const V& value) noexcept {
    static_assert(std::is_arithmetic_v<V>);
    put(&value, sizeof value);
  }
  SKINCTL_INLINE void put(const void* data, std::size_t n) noexcept {
    std::memcpy(at_, data, n);
    at_ += n;
  }
  [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(at_ - begin_); }

 private:
  unsigned char* begin_;
  unsigned char* at_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
