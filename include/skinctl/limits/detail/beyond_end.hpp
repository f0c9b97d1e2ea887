// SPDX-License-Identifier: BSD-3-Clause
// A joint by torque that is beyond its end, held where it is.
#pragma once

#include "skinctl/robot/detail/held_friction.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The place at which a joint is held beyond one of its ends; trivially copyable.
///
/// It is the nearest to the end at which the joint has been since it was measured beyond it, or the end if it
/// came from inside: so an arm that starts beyond an end is held where it is, and one that moves back is not
/// hindered. `play` lies between, so that noise of positions does not move the place, and the joint with it.
template <Real T>
struct BeyondEnd {
  T place = T(0);  ///< distance beyond the end, along the way out [rad]

  /// Takes the cycle's measurement.
  ///
  /// @param past   distance beyond the end [rad], < 0 before it.
  /// @param ahead  time constant of the braking [s].
  /// @param play   distance from which on a joint is held behind the place where it has been [rad].
  /// @param mass   inertia of the joint [kg m^2].
  /// @param limit  torque limit of the joint [N m].
  /// @param known  whether `place` is that of the last cycle.
  SKINCTL_INLINE void observe(const T& past, const T& ahead, const T& play, const T& mass, const T& limit,
                              bool known) noexcept {
    const T nearest = past > T(0) ? T(past + play) : T(0);
    if (!(known && place < nearest)) place = nearest;
    // As of a stop, what holds gives way above a share of the torque: who is held down can free himself.
    const T most = T(hold_share) * limit * lag(ahead) * ahead;
    if (mass * (past - place) > most) place = past - most / mass;
  }
  /// The largest speed outwards of a joint that is `past` > 0 beyond its end [rad/s]: < 0 beyond the place.
  [[nodiscard]] SKINCTL_INLINE T speed(const T& past, const T& ahead) const noexcept {
    const T over = past - place;
    return over > T(0) ? T(-over / lag(ahead)) : T(0);
  }
  /// The part of `push` > 0 outwards that prevails over what holds a joint [N m]; counted as it moves on at
  /// `v`, all of it from the speed `creep` on [rad/s].
  [[nodiscard]] static SKINCTL_INLINE T prevails(const T& push, const T& v, const T& creep,
                                                 const T& limit) noexcept {
    const T more = push - T(hold_share) * limit;
    return more > T(0) && v > T(0) ? T(more * (v < creep ? T(v / creep) : T(1))) : T(0);
  }
  /// The time constant of the way back to the place [s]: the braking damps it critically.
  [[nodiscard]] static SKINCTL_INLINE T lag(const T& ahead) noexcept { return T(4) * ahead; }
};

/// Brakes what a spring gives back to a joint on its way to its place, but not what the law drives inside.
///
/// @param driven  change of speed to which the law's torque leads [rad/s].
/// @param lower   bounds of the speed [rad/s]: a lower one above 0, or an `upper` one below, is that of a
///                spring, see `BeyondEnd::speed`; `lower_by_end` and `upper_by_end`, whether they come from an
///                end.
template <Real T>
SKINCTL_INLINE void brake_return(const T& driven, T& lower, T& upper, bool& lower_by_end,
                                 bool& upper_by_end) noexcept {
  if (upper < T(0)) lower = driven < T(0) ? T(upper + driven) : upper, lower_by_end = true;
  if (lower > T(0)) upper = driven > T(0) ? T(lower + driven) : lower, upper_by_end = true;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
