// Affine forms in lanes: how a value depends on the inputs of a box, to first order, and what is left.
#pragma once

#include <cstddef>
#include <cstdint>

#include "bench/studies/proofs/lane_enclosure.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// The inputs on which a value depends, in order; its other slopes are zero and never written.
struct InputSet {
  const std::uint16_t* first = nullptr;
  std::size_t count = 0;

  [[nodiscard]] const std::uint16_t* begin() const noexcept { return first; }
  [[nodiscard]] const std::uint16_t* end() const noexcept { return first + count; }
};

/// `centre + sum_i slope_i e_i + rest e`, all e in [-1, 1] and e_i the place of input i in the box; and,
/// independently, an enclosure of the same value. Where the box is narrow the form is the tighter of the two,
/// because it knows that two values depend on the same input; its excess falls with the square of the box.
template <class L>
struct LaneForm {
  LaneEnclosure<L> range;
  L centre, rest;
  L radius;  ///< of the form: all slopes, and the rest
  L* slope;

  [[nodiscard]] SKINCTL_INLINE L largest() const noexcept { return range.largest(); }

  SKINCTL_INLINE void set(const LaneEnclosure<L>& of, InputSet n) noexcept {
    range = of;
    centre = L(0.5) * of.low + L(0.5) * of.high;
    radius = rest = max(of.high - centre, centre - of.low) * L(1 + 0x1p-50) + L(tiny);
    for (const std::size_t i : n) slope[i] = L(0.0);
  }
  /// The range is no wider than the form.
  SKINCTL_INLINE void tighten() noexcept {
    const LaneEnclosure<L> of = rounded_outwards(centre - radius, centre + radius);
    range.low = max(range.low, of.low);
    range.high = min(range.high, of.high);
  }
  /// After `slope`, `centre` and `rest` are written with the rounding errors of a few operations.
  SKINCTL_INLINE void close(L slopes) noexcept {
    rest = rest + (abs(centre) + slopes + rest) * L(0x1p-47) + L(tiny);
    radius = (slopes + rest) * L(1 + 0x1p-46);
    tighten();
  }
  /// Room for an error of at most `by`.
  SKINCTL_INLINE void widen(L by) noexcept {
    range = rounded_outwards(range.low - by, range.high + by);
    rest = rest + by;
    radius = (radius + by) * L(1 + 0x1p-50);
  }
};

/// `y = a + s b`, s = 1 or -1; y may be a.
template <class L>
SKINCTL_INLINE void add(const LaneForm<L>& a, double s, const LaneForm<L>& b, LaneForm<L>& y,
                        InputSet n) noexcept {
  y.range = s > 0 ? a.range + b.range : a.range - b.range;
  y.centre = a.centre + L(s) * b.centre;
  y.rest = a.rest + b.rest;
  L slopes(0.0);
  for (const std::size_t i : n) {
    y.slope[i] = a.slope[i] + L(s) * b.slope[i];
    slopes = slopes + abs(y.slope[i]);
  }
  y.close(slopes);
}
template <class L>
SKINCTL_INLINE void multiply(const LaneForm<L>& a, const LaneForm<L>& b, LaneForm<L>& y,
                             InputSet n) noexcept {
  y.range = &a == &b ? square(a.range) : a.range * b.range;
  const L ca = a.centre, cb = b.centre;
  L slopes(0.0), both(0.0), shared(0.0);
  for (const std::size_t i : n) {
    const L p = a.slope[i], q = b.slope[i], r = p * q;
    both = both + r;
    shared = shared + abs(r);
    y.slope[i] = ca * q + cb * p;
    slopes = slopes + abs(y.slope[i]);
  }
  y.centre = ca * cb + L(0.5) * both;
  // Of the product of both deviations, the squares of the inputs' places lie between 0 and 1.
  y.rest =
      a.radius * b.radius * L(1 + 0x1p-48) - L(0.5 - 0x1p-48) * shared + abs(ca) * b.rest + abs(cb) * a.rest;
  y.close(slopes);
}
template <class L>
SKINCTL_INLINE void multiply(const LaneForm<L>& a, const LaneEnclosure<L>& b, LaneForm<L>& y,
                             InputSet n) noexcept {
  y.range = a.range * b;
  const L cb = L(0.5) * b.low + L(0.5) * b.high;
  const L rb = max(b.high - cb, cb - b.low);
  L slopes(0.0);
  for (const std::size_t i : n) {
    y.slope[i] = cb * a.slope[i];
    slopes = slopes + abs(y.slope[i]);
  }
  y.centre = a.centre * cb;
  y.rest = abs(cb) * a.rest + (abs(a.centre) + a.radius) * rb * L(1 + 0x1p-48);
  y.close(slopes);
}
/// Sine or cosine of an input, the `k`-th: `centre + radius e_k` of it.
///
/// sin(c + r e) = sin c cos(r e) + cos c sin(r e), where cos(r e) lies between cos r and 1, and
/// |sin(r e) - e sin r| <= 0.0642 r^3, because the slope of sin(y)/y over y^2 is at most 1/6.
template <class L>
SKINCTL_INLINE void sine_or_cosine(const LaneForm<L>& x, bool sine, std::size_t k, LaneForm<L>& y,
                                   InputSet n) noexcept {
  LaneEnclosure<L> s, c;
  sincos(x.range, s, c);
  y.range = sine ? s : c;
  const auto at = math::sincos(x.centre), half = math::sincos(min(x.radius, L(3.0)));
  const L one(1.0);
  const L value = sine ? at.sin : at.cos, other = sine ? at.cos : -at.sin;
  L slopes(0.0);
  for (const std::size_t i : n) y.slope[i] = L(0.0);
  y.slope[k] = other * half.sin;
  slopes = abs(y.slope[k]);
  y.centre = value * (L(0.5) + L(0.5) * half.cos);
  y.rest = abs(value) * (L(0.5) - L(0.5) * half.cos) +
           abs(other) * (x.radius * x.radius * x.radius * L(0.0642)) + L(0x1p-50);
  const auto narrow = x.radius < L(2.9);
  y.rest = select(narrow, y.rest, one + one);
  y.close(slopes);
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
