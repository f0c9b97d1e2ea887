// Enclosures in lanes: several boxes at once.
#pragma once

#include "bench/studies/proofs/enclosure.hpp"
#include "bench/studies/proofs/rounding_unit.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/math/sincos.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// As `Enclosure`, but every end is moved outwards, exact or not: by two units in its last place and the
/// smallest normal number. Ends are numbers, never NaN, as long as no operand is infinite.
template <class L>
struct LaneEnclosure {
  L low, high;

  [[nodiscard]] SKINCTL_INLINE L largest() const noexcept { return max(abs(low), abs(high)); }
};

template <class L>
SKINCTL_INLINE L lane_slack(L x) noexcept {
  return abs(x) * L(0x1p-51) + L(tiny);
}
template <class L>
SKINCTL_INLINE LaneEnclosure<L> rounded_outwards(L low, L high) noexcept {
  return {low - lane_slack(low), high + lane_slack(high)};
}
template <class L>
SKINCTL_INLINE LaneEnclosure<L> operator-(const LaneEnclosure<L>& a) noexcept {
  return {-a.high, -a.low};
}
template <class L>
SKINCTL_INLINE LaneEnclosure<L> operator+(const LaneEnclosure<L>& a, const LaneEnclosure<L>& b) noexcept {
  return rounded_outwards(a.low + b.low, a.high + b.high);
}
template <class L>
SKINCTL_INLINE LaneEnclosure<L> operator-(const LaneEnclosure<L>& a, const LaneEnclosure<L>& b) noexcept {
  return rounded_outwards(a.low - b.high, a.high - b.low);
}
template <class L>
SKINCTL_INLINE LaneEnclosure<L> operator*(const LaneEnclosure<L>& a, const LaneEnclosure<L>& b) noexcept {
  const L p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
  return rounded_outwards(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)));
}
template <class L>
SKINCTL_INLINE LaneEnclosure<L> square(const LaneEnclosure<L>& a) noexcept {
  const L p = a.low * a.low, q = a.high * a.high, zero(0.0);
  const auto astride = (a.low < zero) & (a.high > zero);
  return rounded_outwards(select(astride, zero, min(p, q)), max(p, q));
}
/// Where `b` contains zero the result is without bound: its ends are infinite.
template <class L>
SKINCTL_INLINE LaneEnclosure<L> operator/(const LaneEnclosure<L>& a, const LaneEnclosure<L>& b) noexcept {
  const L zero(0.0), one(1.0), endless(std::numeric_limits<double>::infinity());
  const auto good = (b.low > zero) | (b.high < zero);
  const LaneEnclosure<L> inverse =
      rounded_outwards(one / select(good, b.high, one), one / select(good, b.low, one));
  const LaneEnclosure<L> y = a * inverse;
  return {select(good, y.low, -endless), select(good, y.high, endless)};
}

/// Sine and cosine at once. An interval below half a turn holds an extreme of one where the other changes its
/// sign.
template <class L>
SKINCTL_INLINE void sincos(const LaneEnclosure<L>& x, LaneEnclosure<L>& sin, LaneEnclosure<L>& cos) noexcept {
  const auto from = math::sincos(x.low), to = math::sincos(x.high);
  const L one(1.0), slack(0x1p-50), zero(0.0);
  const auto narrow = (x.high - x.low) < L(3.14);
  const auto ends = [&](L a, L b, auto top, auto bottom) SKINCTL_INLINE_LAMBDA {
    return LaneEnclosure<L>{select(narrow & !bottom, max(-one, min(a, b) - slack), -one),
                            select(narrow & !top, min(one, max(a, b) + slack), one)};
  };
  sin = ends(from.sin, to.sin, (from.cos >= zero) & (to.cos <= zero), (from.cos <= zero) & (to.cos >= zero));
  cos = ends(from.cos, to.cos, (from.sin <= zero) & (to.sin >= zero), (from.sin >= zero) & (to.sin <= zero));
}

/// Each lane by the enclosure of one number.
template <class L, class F>
LaneEnclosure<L> each_lane(const LaneEnclosure<L>& a, F&& f) noexcept {
  double low[L::lanes], high[L::lanes];
  a.low.store(low), a.high.store(high);
  for (std::size_t i = 0; i < L::lanes; ++i) {
    const Enclosure y = f(Enclosure(low[i], high[i]));
    low[i] = y.low, high[i] = y.high;
  }
  return {L::load(low), L::load(high)};
}
/// As that of a number.
template <std::size_t W>
SKINCTL_INLINE Lane<double, W> power_of_two_below(const Lane<double, W>& x) noexcept {
  using Word = typename skinctl::detail::LaneTypes<double, 1>::Word;
  return skinctl::detail::to_lane<double, W>(skinctl::detail::to_bits<double, W>(x.vector()) &
                                             Word(0x7ff0000000000000));
}
/// `turning_error` in lanes.
template <class L>
[[nodiscard]] L turning(const double (&error)[turning_steps], const LaneEnclosure<L>& v) noexcept {
  const L zero(0.0), high = v.largest();
  const L low = select((v.low <= zero) & (v.high >= zero), zero, min(abs(v.low), abs(v.high)));
  L most(0.0);
  for (std::size_t i = 0; i < turning_steps; ++i) {
    const auto meets = (low <= L(turning_ends[i + 1] + 0.0005)) & (high >= L(turning_ends[i] - 0.0005));
    most = max(most, select(meets, L(error[i]), zero));
  }
  return most;
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
