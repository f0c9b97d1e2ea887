// Bound: a scalar that carries the exact value of a computation and what rounding made of it.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "bench/studies/proofs/enclosure.hpp"
#include "bench/studies/proofs/limits_like.hpp"
#include "bench/studies/proofs/rounding_unit.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The number of comparisons on this thread, since it was last set to zero, whose outcome the error left
/// open. They went by the middle of the enclosures: what follows them is no bound.
inline std::uint64_t& undecided() noexcept {
  static thread_local std::uint64_t count = 0;
  return count;
}

/// A scalar for error bounds of a program that computes in `R`, float or double: an enclosure of the exact
/// value, and a bound of the error of the value that the program has in its place. Any algorithm of the
/// library takes it as its `Real` and runs unaltered.
///
/// The bound is the running error of every operation: `e(a + b) = e(a) + e(b) + u(|a + b| + e(a) + e(b))`,
/// and so on, where `u(x)` is half a unit in the last place of x; a fused multiplication and addition only
/// lowers it. Sines, cosines and tanh have the error that their kernels are proven to have
/// (`rounding_unit.hpp`); other functions of the C library are taken to be accurate to one unit in the last
/// place. A number from a double starts with the error of its rounding to `R`; the exact value is the double
/// itself.
///
/// Comparisons are decided by the enclosures of what exact and rounded program compare; where these overlap
/// the outcome is counted in `undecided()`. Where a result has no bound (a quotient by an interval with zero)
/// the error is infinite.
template <class R>
class Bound {
  static_assert(std::is_same_v<R, float> || std::is_same_v<R, double>, "Bound<R>: R is float or double");

 public:
  constexpr Bound() noexcept = default;
  template <class U>
    requires std::is_arithmetic_v<U>
  constexpr explicit(false) Bound(U x) noexcept
      : value_(static_cast<double>(x)), error_(detail::constant_error<R>(static_cast<double>(x))) {}
  /// An exact value that lies in `value`, computed with an error of at most `error`.
  Bound(const Enclosure& value, double error) noexcept : value_(value), error_(error), id_(++last()) {}
  template <class Q>
  explicit Bound(const Bound<Q>& other) noexcept : Bound(other.value(), other.error()) {
    if constexpr (sizeof(Q) > sizeof(R)) *this = rounded(value_, error_);
  }

  [[nodiscard]] constexpr const Enclosure& value() const noexcept { return value_; }
  [[nodiscard]] constexpr double error() const noexcept { return error_; }
  /// What the exact and the rounded program may have here.
  [[nodiscard]] Enclosure computed() const noexcept {
    return error_ == 0 ? value_ : detail::widened(value_.low, value_.high, error_);
  }
  /// The middle of the enclosure: for texts and times. What depends on it is no longer bounded.
  template <class U>
    requires std::is_arithmetic_v<U>
  constexpr explicit operator U() const noexcept {
    return static_cast<U>(value_.middle());
  }

  friend Bound operator-(const Bound& a) noexcept { return {-a.value_, a.error_}; }
  friend Bound operator+(const Bound& a) noexcept { return a; }
  friend Bound operator+(const Bound& a, const Bound& b) noexcept {
    if (a.is(0)) return b;
    if (b.is(0)) return a;
    return rounded(a.value_ + b.value_, a.error_ + b.error_);
  }
  friend Bound operator-(const Bound& a, const Bound& b) noexcept { return a + -b; }
  friend Bound operator*(const Bound& a, const Bound& b) noexcept {
    const Enclosure v = &a == &b ? square(a.value_) : a.value_ * b.value_;
    const double e = a.value_.largest() * b.error_ + b.value_.largest() * a.error_ + a.error_ * b.error_;
    if (a.scales() || b.scales()) return {v, detail::upper(e)};
    return rounded(v, e);
  }
  friend Bound operator/(const Bound& a, const Bound& b) noexcept {
    if (std::isinf(b.value_.low) && b.value_.is_point()) return Bound(0);
    const Enclosure v = a.value_ / b.value_;
    const double least = b.value_.smallest() - b.error_;
    if (!(least > 0)) return {Enclosure::everything(), std::numeric_limits<double>::infinity()};
    return rounded(v, (a.error_ + v.largest() * b.error_) / least);
  }
  Bound& operator+=(const Bound& b) noexcept { return *this = *this + b; }
  Bound& operator-=(const Bound& b) noexcept { return *this = *this - b; }
  Bound& operator*=(const Bound& b) noexcept { return *this = *this * b; }
  Bound& operator/=(const Bound& b) noexcept { return *this = *this / b; }

  friend bool operator<(const Bound& a, const Bound& b) noexcept {
    const Enclosure x = a.computed(), y = b.computed();
    if (x.high < y.low) return true;
    if (x.low >= y.high || a.is_copy_of(b)) return false;
    if (a.is_number() && b.is_number()) ++undecided();
    return a.value_.middle() < b.value_.middle();
  }
  friend bool operator>(const Bound& a, const Bound& b) noexcept { return b < a; }
  friend bool operator<=(const Bound& a, const Bound& b) noexcept {
    const Enclosure x = a.computed(), y = b.computed();
    if (x.high <= y.low || a.is_copy_of(b)) return true;
    if (x.low > y.high) return false;
    if (a.is_number() && b.is_number()) ++undecided();
    return a.value_.middle() <= b.value_.middle();
  }
  friend bool operator>=(const Bound& a, const Bound& b) noexcept { return b <= a; }
  friend bool operator==(const Bound& a, const Bound& b) noexcept {
    const Enclosure x = a.computed(), y = b.computed();
    if (x.high < y.low || y.high < x.low) return false;
    if (a.is_copy_of(b)) return true;
    if (x.is_point() && y.is_point()) return x.low == y.low;
    if (a.is_number() && b.is_number()) ++undecided();
    return a.value_.middle() == b.value_.middle();
  }

  friend Bound abs(const Bound& a) noexcept {
    return a.value_.low >= a.error_ ? a : Bound(abs(a.value_), a.error_);
  }
  friend Bound copysign(const Bound& a, const Bound& b) noexcept { return b < Bound(0) ? -abs(a) : abs(a); }
  friend Bound sqrt(const Bound& a) noexcept {
    const double least = std::fmax(a.value_.low, 0.0);
    const double down = std::sqrt(std::fmax(least - a.error_, 0.0)) + std::sqrt(least);
    const double e = a.error_ == 0 ? 0 : (down > 0 ? a.error_ / down : std::sqrt(a.error_));
    return rounded(sqrt(a.value_), std::fmin(e, std::sqrt(a.error_)));
  }
  friend Bound sin(const Bound& a) noexcept { return turned(sin(a.value_), a.error_); }
  friend Bound cos(const Bound& a) noexcept { return turned(cos(a.value_), a.error_); }
  friend Bound tanh(const Bound& a) noexcept {
    return {tanh(a.value_), detail::upper(a.error_ + detail::kernel_error<R>::tanh)};
  }
  friend Bound exp(const Bound& a) noexcept {
    const Enclosure v = exp(a.value_);
    const double e = v.high * std::expm1(a.error_);
    return {v, detail::upper(e + 2 * detail::half_ulp<R>(v.high + e))};
  }
  /// Of positive numbers; infinite otherwise.
  friend Bound pow(const Bound& x, const Bound& y) noexcept {
    const Enclosure a = x.computed(), b = y.computed();
    if (!(a.low > 0)) return {Enclosure::everything(), std::numeric_limits<double>::infinity()};
    double low = std::numeric_limits<double>::infinity(), high = 0, slope = 0, steepest = 0;
    for (const double s : {a.low, a.high})
      for (const double t : {b.low, b.high}) {
        low = std::fmin(low, std::pow(s, t)), high = std::fmax(high, std::pow(s, t));
        slope = std::fmax(slope, std::pow(s, t - 1));
        steepest = std::fmax(steepest, std::fabs(std::log(s)));
      }
    const double e = slope * b.largest() * x.error_ + high * steepest * y.error_;
    return {detail::outwards(low, high), detail::upper(e + 2 * detail::half_ulp<R>(high + e))};
  }
  friend Bound atan2(const Bound& y, const Bound& x) noexcept {
    const Enclosure a = y.computed(), b = x.computed();
    const double r2 = square(a).low + square(b).low;
    if (!(r2 > 0) || (b.low < 0 && a.contains(0) && !a.is_point())) {
      ++undecided();
      return {Enclosure(-3.1415927, 3.1415927), 6.2831854};
    }
    double low = 4, high = -4;
    for (const double s : {y.value_.low, y.value_.high})
      for (const double c : {x.value_.low, x.value_.high}) {
        low = std::fmin(low, std::atan2(s, c)), high = std::fmax(high, std::atan2(s, c));
      }
    const double e = (y.error_ + x.error_) / std::sqrt(r2);
    return {detail::outwards(low, high), detail::upper(e + 2 * detail::half_ulp<R>(3.2))};
  }

 private:
  /// An exact value, and the error of what is rounded in its place.
  static Bound rounded(const Enclosure& v, double e) noexcept {
    return {v, detail::upper(e + detail::half_ulp<R>(v.largest() + e))};
  }
  static Bound turned(const Enclosure& v, double e) noexcept {
    const double own = detail::turning_error(detail::kernel_error<R>::turning, v.smallest() - e,
                                             std::fmin(v.largest() + e, 1.0));
    return {v, detail::upper(e + own)};
  }
  constexpr bool is(double x) const noexcept { return error_ == 0 && value_.low == x && value_.high == x; }
  constexpr bool is_number() const noexcept { return value_.low == value_.low && value_.high == value_.high; }
  /// Copies have the same rounded value; so have equal constants.
  constexpr bool is_copy_of(const Bound& b) const noexcept {
    return id_ == b.id_ && value_.low == b.value_.low && value_.high == b.value_.high && is_number();
  }
  static std::uint64_t& last() noexcept {
    static thread_local std::uint64_t id = 0;
    return id;
  }
  /// Multiplication by it is exact: zero, or a power of two.
  bool scales() const noexcept {
    return error_ == 0 && value_.is_point() && detail::is_power_of_two_or_zero(value_.low);
  }

  Enclosure value_;
  double error_ = 0;
  std::uint64_t id_ = 0;  // which operation made it; 0: a constant
};

}  // namespace math
SKINCTL_END_NAMESPACE

/// @cond
template <class R>
struct std::numeric_limits<skinctl::math::Bound<R>>
    : skinctl::detail::LimitsLike<skinctl::math::Bound<R>, R> {};
/// @endcond
