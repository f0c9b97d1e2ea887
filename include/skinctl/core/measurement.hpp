// SPDX-License-Identifier: BSD-3-Clause
// The last good measurement of a robot.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Accepts every finite state. A `Guard` accepts only states that its robot can reach.
struct AnyState {
  template <std::size_t N, Real T>
  static constexpr bool believes(const State<N, T>&) noexcept {
    return true;
  }
};

/// Makes `measured` the last good state, `good`, unless it is NaN, infinite or absurdly large
/// (`state_not_finite`), implausible (`state_out_of_range`), or older than `good` (`time_backwards`). A stamp
/// in the future becomes `now`, and so does that of `good` if the clock was set back.
///
/// A resolver calls this once a cycle and keeps the last good state: `memory.measured`. Governor and guard
/// read it there; a guard without a resolver needs a `State` of its own and this function.
///
/// @param check  has `believes(state)`: a guard, or `AnyState`.
template <std::size_t N, Real T, class Check = AnyState>
[[nodiscard]] SKINCTL_INLINE Status take_measurement(State<N, T>& good, const State<N, T>& measured,
                                                     Nanoseconds now, const Check& check = {}) noexcept {
  if (good.time > now) [[unlikely]]
    good.time = now;
  if (!detail::is_plausible(measured)) return Reason::state_not_finite;
  if (!check.believes(measured)) return Reason::state_out_of_range;
  if (measured.time < good.time) return Reason::time_backwards;
  good.q = measured.q;
  good.dq = measured.dq;
  good.time = measured.time > now ? now : measured.time;
  return {};
}

namespace detail {
/// The state for a cycle that integrates nothing: the newest measurement if it is plausible, else the last
/// good one.
template <std::size_t N, Real T, class Check>
[[nodiscard]] SKINCTL_INLINE const State<N, T>& believed(const State<N, T>& measured, const State<N, T>& good,
                                                         const Check& check) noexcept {
  return is_plausible(measured) && check.believes(measured) ? measured : good;
}
}  // namespace detail

SKINCTL_END_NAMESPACE
