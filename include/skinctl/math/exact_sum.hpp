// Exact sums: the policy Exact of Sum. Only the result is rounded.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "skinctl/math/sum.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The exact sum of any floats or doubles in any order, for up to 2^63 terms: `value()` is the true sum
/// rounded once, to nearest, ties to even; infinite if that overflows. Partial sums may exceed the range of
/// `T`.
///
/// The accumulator is a fixed-point number in steps of the smallest subnormal, with digits of 32 bits and
/// delayed carries; a term changes three digits (Neal 2015, Fast exact summation using small and large
/// superaccumulators). A NaN, or infinities of both signs, give NaN; infinities of one sign give that
/// infinity. An empty sum and a sum of -0 are +0. Not for lanes.
template <class T>
class Sum<T, Exact> {
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>, "Sum<T, Exact>: float or double");
  static_assert(std::numeric_limits<T>::is_iec559, "Sum<T, Exact>: IEEE 754 numbers");
  using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  static constexpr int digits = std::numeric_limits<T>::digits;
  static constexpr Bits hidden = Bits(1) << (digits - 1);
  static constexpr Bits exponents = 2 * static_cast<Bits>(std::numeric_limits<T>::max_exponent) - 1;
  static constexpr std::size_t words = (exponents - 2) / 32 + 4;
  static constexpr std::uint32_t most_pending = std::uint32_t(1) << 30;

 public:
  constexpr Sum() noexcept = default;
  constexpr explicit Sum(T start) noexcept { *this += start; }

  constexpr Sum& operator+=(T x) noexcept {
    const auto bits = std::bit_cast<Bits>(x);
    const Bits exponent = (bits >> (digits - 1)) & exponents;
    if (exponent == exponents) {
      not_finite_ += x;
      return *this;
    }
    if (pending_ == most_pending) carry();
    ++pending_;
    const std::uint64_t mantissa = (bits & (hidden - 1)) | (exponent == 0 ? Bits(0) : hidden);
    const auto place = static_cast<std::size_t>(exponent == 0 ? Bits(0) : exponent - 1);
    const std::uint64_t low = (mantissa & low_bits) << (place % 32);
    const std::uint64_t high = ((mantissa >> 32) << (place % 32)) + (low >> 32);
    const std::int64_t sign = (bits >> (sizeof(T) * 8 - 1)) != 0 ? -1 : 1;
    std::int64_t* const word = words_ + place / 32;
    word[0] += sign * static_cast<std::int64_t>(low & low_bits);
    word[1] += sign * static_cast<std::int64_t>(high & low_bits);
    word[2] += sign * static_cast<std::int64_t>(high >> 32);
    return *this;
  }
  constexpr Sum& operator-=(T x) noexcept { return *this += -x; }
  /// Adds another sum: partial sums may be computed anywhere and combined in any order.
  constexpr Sum& operator+=(const Sum& other) noexcept {
    Sum carried = other;
    carried.carry();
    carry();
    ++pending_;
    for (std::size_t i = 0; i < words; ++i) words_[i] += carried.words_[i];
    not_finite_ += other.not_finite_;
    return *this;
  }

  [[nodiscard]] constexpr T value() const noexcept {
    if (not_finite_ != T(0)) return not_finite_;
    Sum s = *this;
    s.carry();
    const bool negative = s.words_[words - 1] < 0;
    if (negative) {
      for (auto& word : s.words_) word = -word;
      s.carry();
    }
    const T magnitude = s.rounded();
    return negative ? -magnitude : magnitude;
  }

 private:
  static constexpr std::uint64_t low_bits = 0xffffffffu;

  /// Brings all words but the last into [0, 2^32).
  constexpr void carry() noexcept {
    for (std::size_t i = 0; i + 1 < words; ++i) {
      const std::int64_t over = words_[i] >> 32;
      words_[i] -= over * (std::int64_t(1) << 32);
      words_[i + 1] += over;
    }
    pending_ = 1;
  }
  /// The rounded value of a carried, non-negative sum.
  [[nodiscard]] constexpr T rounded() const noexcept {
    const auto word = [&](std::size_t i) { return static_cast<std::uint64_t>(words_[i]); };
    if (word(words - 1) > low_bits) return std::numeric_limits<T>::infinity();
    std::size_t k = words - 1;
    while (k > 0 && words_[k] == 0) --k;
    if (words_[k] == 0) return T(0);
    // The 64 bits from the highest one on, and whether any is set below them.
    const std::uint64_t second = k > 0 ? word(k - 1) : 0, third = k > 1 ? word(k - 2) : 0;
    const int zeros = std::countl_zero(word(k) << 32 | second);
    const std::uint64_t top = (word(k) << 32 | second) << zeros | (third << zeros) >> 32;
    bool below = ((third << zeros) & low_bits) != 0;
    for (std::size_t i = 0; i + 2 < k; ++i) below = below || words_[i] != 0;
    const int highest = static_cast<int>(32 * k) + 31 - zeros;
    const int lowest = highest < digits ? 0 : highest - (digits - 1);
    const int kept = highest - lowest + 1;
    std::uint64_t mantissa = top >> (64 - kept);
    const std::uint64_t rest = top << kept, half = std::uint64_t(1) << 63;
    if (rest > half || (rest == half && (below || mantissa % 2 != 0))) ++mantissa;
    // The leading one is the last bit of the exponent, so that subnormals need no case of their own.
    const std::uint64_t bits = (static_cast<std::uint64_t>(lowest) << (digits - 1)) + mantissa;
    constexpr std::uint64_t infinite = std::uint64_t(exponents) << (digits - 1);
    return std::bit_cast<T>(static_cast<Bits>(bits < infinite ? bits : infinite));
  }

  std::int64_t words_[words] = {};
  std::uint32_t pending_ = 1;  // terms since the last carry, each below 2^32 in a word
  T not_finite_ = T(0);
};

}  // namespace math
SKINCTL_END_NAMESPACE
