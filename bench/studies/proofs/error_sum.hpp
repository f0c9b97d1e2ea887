// The sum of the errors of all operations over a box.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/studies/proofs/lane_form.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// `sum_k |adjoint_k| delta_k`: term by term, and as a form over the inputs, because the terms are not all
/// largest at the same place of the box. Where an adjoint changes its sign, a chord is above its magnitude.
template <class L>
struct ErrorSum {
  L plain, centre, rest;
  std::vector<L> slope;

  void clear(std::size_t n) {
    plain = centre = rest = L(0.0);
    slope.assign(n, L(0.0));
  }
  void add(const LaneForm<L>& a, const L& delta, InputSet n) noexcept {
    const L zero(0.0), one(1.0), low = a.range.low, high = a.range.high;
    plain = plain + delta * a.largest();
    const auto positive = low >= zero, negative = high <= zero;
    const L sign = select(positive, one, select(negative, -one, (high + low) / (high - low)));
    const L above = select(positive | negative, zero, high * (one - sign) * L(1 + 0x1p-48));
    centre = centre + delta * (sign * a.centre + above);
    rest = rest + delta * abs(sign) * a.rest;
    const L by = delta * sign;
    for (const std::size_t i : n) slope[i] = slope[i] + by * a.slope[i];
  }
};
/// The largest of `u` times the one sum plus the other, in the box.
template <class L>
L largest(const ErrorSum<L>& a, double u, const ErrorSum<L>& b, std::size_t n) noexcept {
  const L plain = L(u) * a.plain + b.plain;
  L form = L(u) * (a.centre + a.rest) + (b.centre + b.rest);
  for (std::size_t i = 0; i < n; ++i) form = form + abs(L(u) * a.slope[i] + b.slope[i]);
  // The sums' own rounding is relative to their terms' magnitudes.
  return min(plain * L(1 + 0x1p-40), form + plain * L(0x1p-38) + (L(u) * a.rest + b.rest) * L(0x1p-38));
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
