// Enclosure: two doubles between which a real number lies, whatever the rounding on the way there.
#pragma once

#include <cmath>
#include <initializer_list>
#include <limits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The numbers from `low` to `high`: every operation contains the exact result for all numbers of its
/// operands.
///
/// Computed in the usual rounding to nearest; an end is moved outwards by one number only where the result
/// was not exact. A result that is not bounded (a quotient by zero) is the whole line. NaN stays in both
/// ends.
struct Enclosure {
  double low = 0, high = 0;

  constexpr Enclosure() noexcept = default;
  constexpr Enclosure(double x) noexcept : low(x), high(x) {}
  constexpr Enclosure(double from, double to) noexcept : low(from), high(to) {}

  [[nodiscard]] static constexpr Enclosure everything() noexcept {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  /// The largest and the smallest magnitude of its numbers.
  [[nodiscard]] double largest() const noexcept { return std::fmax(std::fabs(low), std::fabs(high)); }
  [[nodiscard]] double smallest() const noexcept {
    return contains(0) ? 0 : std::fmin(std::fabs(low), std::fabs(high));
  }
  [[nodiscard]] constexpr double width() const noexcept { return high - low; }
  [[nodiscard]] constexpr double middle() const noexcept { return 0.5 * low + 0.5 * high; }
  [[nodiscard]] constexpr bool contains(double x) const noexcept { return low <= x && x <= high; }
  [[nodiscard]] constexpr bool is_point() const noexcept { return low == high; }
};

namespace detail {
inline constexpr double tiny = std::numeric_limits<double>::min();

inline double below(double x) noexcept {
  return std::nextafter(x, -std::numeric_limits<double>::infinity());
}
inline double above(double x) noexcept {
  return std::nextafter(x, std::numeric_limits<double>::infinity());
}
/// An upper limit of a sum or product of few positive numbers, itself computed in double.
[[nodiscard]] constexpr double upper(double x) noexcept {
  return x * (1 + 0x1p-48);
}

/// The ends of a sum, from the rounding error that Knuth's two-sum leaves.
inline double sum_below(double a, double b) noexcept {
  const double s = a + b, seen = s - a, rest = (a - (s - seen)) + (b - seen);
  return rest < 0 ? below(s) : s;
}
inline double sum_above(double a, double b) noexcept {
  const double s = a + b, seen = s - a, rest = (a - (s - seen)) + (b - seen);
  return rest > 0 ? above(s) : s;
}
/// The ends of a product. Where the remainder itself may have underflowed, one number more.
inline double product_below(double a, double b) noexcept {
  const double p = a * b;
  if (a == 0 || b == 0) return 0;
  return std::fabs(p) < 1e-250 || std::fma(a, b, -p) < 0 ? below(p) : p;
}
inline double product_above(double a, double b) noexcept {
  const double p = a * b;
  if (a == 0 || b == 0) return 0;
  return std::fabs(p) < 1e-250 || std::fma(a, b, -p) > 0 ? above(p) : p;
}
inline Enclosure widened(double low, double high, double by) noexcept {
  return {sum_below(low, -by), sum_above(high, by)};
}
/// Values of a library's function, which is accurate to one unit in the last place: two units outwards.
inline Enclosure outwards(double low, double high) noexcept {
  return {below(below(low)), above(above(high))};
}
}  // namespace detail

inline Enclosure operator-(const Enclosure& a) noexcept {
  return {-a.high, -a.low};
}
inline Enclosure operator+(const Enclosure& a, const Enclosure& b) noexcept {
  return {detail::sum_below(a.low, b.low), detail::sum_above(a.high, b.high)};
}
inline Enclosure operator-(const Enclosure& a, const Enclosure& b) noexcept {
  return a + -b;
}
inline Enclosure operator*(const Enclosure& a, const Enclosure& b) noexcept {
  using namespace detail;
  return {std::fmin(std::fmin(product_below(a.low, b.low), product_below(a.low, b.high)),
                    std::fmin(product_below(a.high, b.low), product_below(a.high, b.high))),
          std::fmax(std::fmax(product_above(a.low, b.low), product_above(a.low, b.high)),
                    std::fmax(product_above(a.high, b.low), product_above(a.high, b.high)))};
}
/// The whole line where the divisor contains zero.
inline Enclosure operator/(const Enclosure& a, const Enclosure& b) noexcept {
  if (!(b.low > 0 || b.high < 0)) return Enclosure::everything();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double x : {a.low, a.high})
    for (const double y : {b.low, b.high}) {
      const double q = x / y;
      const double rest = std::fma(q, y, -x) * y;  // > 0: q is above x / y
      const bool sure = std::fabs(q) > 1e-250 && std::fabs(x) > 1e-250 && std::isfinite(rest);
      const bool exact = x == 0 || std::isinf(y) || (sure && rest == 0);
      low = std::fmin(low, exact || (sure && rest < 0) ? q : detail::below(q));
      high = std::fmax(high, exact || (sure && rest > 0) ? q : detail::above(q));
    }
  return {low, high};
}
inline Enclosure square(const Enclosure& a) noexcept {
  const double most = a.largest(), least = a.smallest();
  return {detail::product_below(least, least), detail::product_above(most, most)};
}
/// Of the numbers that are not negative; NaN if there is none.
inline Enclosure sqrt(const Enclosure& a) noexcept {
  const auto root = [](double x, bool up) {
    const double r = std::sqrt(x);
    const double rest = std::fma(r, r, -x);
    if (rest == 0 || !(x > 0)) return r;
    return up ? (rest < 0 ? detail::above(r) : r) : (rest > 0 ? detail::below(r) : r);
  };
  return {root(a.high < 0 ? a.high : std::fmax(a.low, 0.0), false), root(a.high, true)};
}
inline Enclosure abs(const Enclosure& a) noexcept {
  return {a.smallest(), a.largest()};
}
inline Enclosure exp(const Enclosure& a) noexcept {
  const Enclosure y = detail::outwards(std::exp(a.low), std::exp(a.high));
  return {std::fmax(y.low, 0.0), y.high};
}
inline Enclosure tanh(const Enclosure& a) noexcept {
  const Enclosure y = detail::outwards(std::tanh(a.low), std::tanh(a.high));
  return {std::fmax(y.low, -1.0), std::fmin(y.high, 1.0)};
}
/// The cosine reaches 1 and -1 at multiples of pi, of which one more is assumed where it is a close call.
inline Enclosure cos(const Enclosure& a) noexcept {
  if (!(a.width() < 6.25) || !(a.largest() < 1e8)) return {-1, 1};
  constexpr double pi = 3.141592653589793, near = 1e-7;
  const Enclosure y = detail::outwards(std::fmin(std::cos(a.low), std::cos(a.high)),
                                       std::fmax(std::cos(a.low), std::cos(a.high)));
  double low = std::fmax(y.low, -1.0), high = std::fmin(y.high, 1.0);
  for (double k = std::floor(a.low / pi - near); k <= std::ceil(a.high / pi + near); k += 1)
    if (k >= a.low / pi - near && k <= a.high / pi + near) {
      // At a close call the function is within near^2 of its extreme anyway.
      if (std::fmod(std::fabs(k), 2.0) == 0)
        high = 1;
      else
        low = -1;
    }
  return {low, high};
}
inline Enclosure sin(const Enclosure& a) noexcept {
  if (!(a.width() < 6.25) || !(a.largest() < 1e8)) return {-1, 1};
  constexpr double pi = 3.141592653589793, near = 1e-7;
  const Enclosure y = detail::outwards(std::fmin(std::sin(a.low), std::sin(a.high)),
                                       std::fmax(std::sin(a.low), std::sin(a.high)));
  double low = std::fmax(y.low, -1.0), high = std::fmin(y.high, 1.0);
  for (double k = std::floor(a.low / pi - 1); k <= std::ceil(a.high / pi); k += 1)
    if (k + 0.5 >= a.low / pi - near && k + 0.5 <= a.high / pi + near) {
      if (std::fmod(std::fabs(k), 2.0) == 0)
        high = 1;
      else
        low = -1;
    }
  return a.is_point() && a.low == 0 ? Enclosure(0) : Enclosure(low, high);
}

}  // namespace math
SKINCTL_END_NAMESPACE
