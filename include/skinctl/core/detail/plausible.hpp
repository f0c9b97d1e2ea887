// SPDX-License-Identifier: BSD-3-Clause
// Plausible measurements: finite, and small enough that arithmetic with them stays finite.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/state.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Larger positions [rad], and speeds above a thousand times this number [rad/s], are no measurements.
inline constexpr double plausible = 1e4;

/// Whether all of `x` lies within +-`limit`; false for NaN.
template <class Kind, std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE bool within(const JointVector<Kind, N, T>& x, const T& limit) noexcept {
  return all(magnitude(Row(x)) <= limit);
}
template <class Kind, std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE bool is_finite(const JointVector<Kind, N, T>& x) noexcept {
  return within(x, std::numeric_limits<T>::max());
}
template <std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE bool is_plausible(const State<N, T>& s) noexcept {
  return within(s.q, T(plausible)) && within(s.dq, T(1000 * plausible));
}
template <std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE bool is_plausible(const JointCommand<N, T>& c) noexcept {
  return within(c.position, T(2 * plausible)) && within(c.velocity, T(1000 * plausible)) &&
         is_finite(c.acceleration) && is_finite(c.torque);
}
/// Whether a time is so far from the ends of an int64 that differences of two fit.
[[nodiscard]] SKINCTL_INLINE constexpr bool is_plausible(Nanoseconds t) noexcept {
  constexpr Nanoseconds far(std::int64_t(1) << 61);
  return t > -far && t < far;
}
template <Real T>
[[nodiscard]] SKINCTL_INLINE T clamp(const T& x, const T& low, const T& high) noexcept {
  return x < low ? low : (x > high ? high : x);
}
template <Real T>
[[nodiscard]] SKINCTL_INLINE T smaller(const T& x, const T& y) noexcept {
  return y < x ? y : x;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
