// Fixed-point numbers, for processors without a floating-point unit.
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// A number in steps of `2^-Fraction` in 32 bits: `Fixed<20>` is Q11.20, from -2048 to 2048. A scalar for
/// poses, Jacobians, G, inverse dynamics and M in SI units on a processor without floating point; with a unit
/// for float, float is several times cheaper. Forward dynamics does not compile: it divides by pivots that
/// have lost their digits.
///
/// Sums wrap around; products and quotients are rounded to the nearest step and wrap as well, a quotient by
/// zero is the largest number of its sign. So choose the format by the largest intermediate value: of a UR5's
/// inverse dynamics at 3 rad/s and 10 rad/s^2 that is a torque of 100 N m, and `Fixed<22>` (up to 512) has
/// room for it. There is no NaN and no infinity: what is not finite becomes the largest number of its sign,
/// NaN zero.
///
/// For a UR5 at up to 3 rad/s and 10 rad/s^2, the worst of 10 000 states: tool 47, 3.2, 0.76 um; G 1.5e-3,
/// 5.7e-5, 1.8e-5 N m; inverse dynamics 2.9e-3, 1.1e-4, 3.6e-5 N m in Q15.16, Q11.20, Q9.22.
template <int Fraction>
class Fixed {
 public:
  static_assert(Fraction > 0 && Fraction < 31, "one sign bit, and something before and behind the point");
  static constexpr int fraction = Fraction;
  static constexpr std::int64_t one = std::int64_t(1) << Fraction;

  constexpr Fixed() noexcept = default;
  /// Rounded to the nearest step; beyond the range the nearest end.
  template <class Number>
    requires std::is_arithmetic_v<Number>
  explicit(!std::is_integral_v<Number>) constexpr Fixed(Number x) noexcept {
    if constexpr (std::is_integral_v<Number>) {
      raw_ = clamped(static_cast<std::int64_t>(x), one);
    } else {
      const double steps = static_cast<double>(x) * static_cast<double>(one);
      raw_ = steps >= 2147483647.0    ? std::numeric_limits<std::int32_t>::max()
             : steps <= -2147483648.0 ? std::numeric_limits<std::int32_t>::min()
             : steps == steps         ? static_cast<std::int32_t>(steps < 0 ? steps - 0.5 : steps + 0.5)
                                      : 0;
    }
  }
  [[nodiscard]] static SKINCTL_INLINE constexpr Fixed of_steps(std::int32_t steps) noexcept {
    Fixed x;
    x.raw_ = steps;
    return x;
  }
  [[nodiscard]] SKINCTL_INLINE constexpr std::int32_t steps() const noexcept { return raw_; }
  template <class Number>
    requires std::is_arithmetic_v<Number>
  [[nodiscard]] explicit constexpr operator Number() const noexcept {
    if constexpr (std::is_integral_v<Number>) {
      return static_cast<Number>(raw_ / one);
    } else {
      return static_cast<Number>(static_cast<double>(raw_) / static_cast<double>(one));
    }
  }

  friend SKINCTL_INLINE constexpr Fixed operator+(Fixed a, Fixed b) noexcept {
    return wrapped(static_cast<std::uint32_t>(a.raw_) + static_cast<std::uint32_t>(b.raw_));
  }
  friend SKINCTL_INLINE constexpr Fixed operator-(Fixed a, Fixed b) noexcept {
    return wrapped(static_cast<std::uint32_t>(a.raw_) - static_cast<std::uint32_t>(b.raw_));
  }
  friend SKINCTL_INLINE constexpr Fixed operator-(Fixed a) noexcept {
    return wrapped(0u - static_cast<std::uint32_t>(a.raw_));
  }
  friend SKINCTL_INLINE constexpr Fixed operator+(Fixed a) noexcept { return a; }
  friend SKINCTL_INLINE constexpr Fixed operator*(Fixed a, Fixed b) noexcept {
    const std::int64_t product = static_cast<std::int64_t>(a.raw_) * b.raw_;
    return wrapped(static_cast<std::uint32_t>((product + (one >> 1)) >> Fraction));
  }
  friend constexpr Fixed operator/(Fixed a, Fixed b) noexcept {
    if (b.raw_ == 0)
      return of_steps(a.raw_ < 0 ? std::numeric_limits<std::int32_t>::min()
                                 : std::numeric_limits<std::int32_t>::max());
    const std::int64_t n = static_cast<std::int64_t>(a.raw_) * one, d = b.raw_,
                       half = d < 0 ? -(d / 2) : d / 2;
    return wrapped(static_cast<std::uint32_t>((n < 0 ? n - half : n + half) / d));
  }
  constexpr Fixed& operator+=(Fixed b) noexcept { return *this = *this + b; }
  constexpr Fixed& operator-=(Fixed b) noexcept { return *this = *this - b; }
  constexpr Fixed& operator*=(Fixed b) noexcept { return *this = *this * b; }
  constexpr Fixed& operator/=(Fixed b) noexcept { return *this = *this / b; }
  friend constexpr bool operator==(Fixed, Fixed) noexcept = default;
  friend constexpr auto operator<=>(Fixed, Fixed) noexcept = default;

  friend constexpr Fixed abs(Fixed x) noexcept { return x.raw_ < 0 ? -x : x; }
  /// Rounded down; zero of what is negative.
  friend constexpr Fixed sqrt(Fixed x) noexcept {
    std::uint64_t rest = x.raw_ > 0 ? static_cast<std::uint64_t>(x.raw_) << Fraction : 0, root = 0;
    for (std::uint64_t bit = std::uint64_t(1) << 62; bit != 0; bit >>= 2) {
      const bool takes = rest >= root + bit;
      if (takes) rest -= root + bit;
      root = (root >> 1) + (takes ? bit : 0);
    }
    return of_steps(static_cast<std::int32_t>(root));
  }
  /// Sine and cosine, rounded to the nearest step, any angle [rad]: polynomials in steps of 2^-30, off by
  /// 2e-9 before.
  friend constexpr void sin_cos(Fixed x, Fixed& sine, Fixed& cosine) noexcept {
    // Quarter turns, by 2/pi in steps of 2^-32; what is left of pi/2 in steps of 2^-60 is exact to 2^-30.
    constexpr std::int64_t two_over_pi = 2734261102, half_pi = 1686629713;  // 2^32, 2^30
    constexpr std::int64_t half_pi_rest = 70064199;                         // 2^60: pi/2 - half_pi 2^-30
    const std::int64_t turns =
        (x.raw_ * two_over_pi + (std::int64_t(1) << (31 + Fraction))) >> (32 + Fraction);
    const std::int64_t far = (static_cast<std::int64_t>(x.raw_) << (30 - Fraction)) - turns * half_pi -
                             ((turns * half_pi_rest) >> 30);
    const auto r = static_cast<std::int32_t>(far);
    const auto times = [](std::int32_t a, std::int32_t b) {
      return static_cast<std::int32_t>((static_cast<std::int64_t>(a) * b + (1 << 29)) >> 30);
    };
    const std::int32_t z = times(r, r);
    // Minimax on |r| <= pi/4, as in the table of float: sin r = r + r z p(z), cos r = 1 - z/2 + z z q(z).
    const std::int32_t p = times(times(-209576, z) + 8946620, z) - 178956848;
    const std::int32_t q = times(times(26232, z) - 1491138, z) + 44739220;
    const std::int32_t s = r + times(times(r, z), p),
                       c = (std::int32_t(1) << 30) - z / 2 + times(times(z, z), q);
    const std::int32_t first = (turns & 1) != 0 ? c : s, second = (turns & 1) != 0 ? s : c;
    sine = from_30((turns & 2) != 0 ? -first : first);
    cosine = from_30(((turns + 1) & 2) != 0 ? -second : second);
  }
  friend constexpr Fixed sin(Fixed x) noexcept {
    Fixed s, c;
    sin_cos(x, s, c);
    return s;
  }
  friend constexpr Fixed cos(Fixed x) noexcept {
    Fixed s, c;
    sin_cos(x, s, c);
    return c;
  }

 private:
  static constexpr std::int32_t clamped(std::int64_t x, std::int64_t unit) noexcept {
    const std::int64_t most = std::numeric_limits<std::int32_t>::max() / unit;
    return x > most ? std::numeric_limits<std::int32_t>::max()
                    : (x < -most - 1 ? std::numeric_limits<std::int32_t>::min()
                                     : static_cast<std::int32_t>(x * unit));
  }
  static SKINCTL_INLINE constexpr Fixed wrapped(std::uint32_t bits) noexcept {
    return of_steps(static_cast<std::int32_t>(bits));
  }
  static SKINCTL_INLINE constexpr Fixed from_30(std::int32_t x) noexcept {
    if constexpr (Fraction == 30) {
      return of_steps(x);
    } else {
      return of_steps((x + (std::int32_t(1) << (29 - Fraction))) >> (30 - Fraction));
    }
  }
  std::int32_t raw_ = 0;
};

using Q15_16 = Fixed<16>;
using Q11_20 = Fixed<20>;
using Q9_22 = Fixed<22>;

}  // namespace math

template <int Fraction>
inline constexpr bool is_fixed_point<math::Fixed<Fraction>> = true;

SKINCTL_END_NAMESPACE

/// @cond
template <int Fraction>
struct std::numeric_limits<skinctl::math::Fixed<Fraction>> {
  using T = skinctl::math::Fixed<Fraction>;
  static constexpr bool is_specialized = true, is_signed = true, is_integer = false, is_exact = false,
                        has_infinity = false, has_quiet_NaN = false, has_signaling_NaN = false,
                        is_iec559 = false, is_bounded = true, is_modulo = true;
  static constexpr int radix = 2, digits = 31, digits10 = 9, max_exponent10 = 0;
  static constexpr T epsilon() noexcept { return T::of_steps(1); }
  static constexpr T min() noexcept { return T::of_steps(1); }
  static constexpr T max() noexcept { return T::of_steps(numeric_limits<std::int32_t>::max()); }
  static constexpr T lowest() noexcept { return T::of_steps(numeric_limits<std::int32_t>::min()); }
  static constexpr T infinity() noexcept { return max(); }
  static constexpr T quiet_NaN() noexcept { return {}; }
};
/// @endcond
