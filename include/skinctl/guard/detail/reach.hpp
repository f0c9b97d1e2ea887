// SPDX-License-Identifier: BSD-3-Clause
// What a guard lets a command reach.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The room of commands, and whether a command may follow the last one.
template <Interface Ix, std::size_t N, Real T>
class GuardReach {
 public:
  [[nodiscard]] const JointLimits<N, T>& limits() const noexcept { return limits_; }
  [[nodiscard]] Nanoseconds period() const noexcept { return period_; }
  [[nodiscard]] Nanoseconds longest_interval() const noexcept { return longest_; }

 protected:
  GuardReach(const JointLimits<N, T>& limits, Nanoseconds period, Nanoseconds longest)
      : limits_(limits), period_(period), longest_(longest) {}

  /// Factor for rounding at a limit.
  static SKINCTL_INLINE T slack() noexcept { return T(1) + T(1024) * std::numeric_limits<T>::epsilon(); }

  /// Distances that a command leaves: of a position to the limits and to its largest distance from the
  /// measured one; of a velocity from the measured position to the limits, and to one that the robot is
  /// leaving more, by the way at the measured speed in the longest interval.
  SKINCTL_INLINE JointRoom<N, T> room(const State<N, T>& measured,
                                      const JointPosition<N, T>& command) const noexcept {
    using R = Row<N, T>;
    const R q = measured.q;
    auto room = limits_.room(takes_position(Ix) ? command : measured.q);
    if constexpr (takes_position(Ix)) {
      const R ahead = R(command) - q, lead = lead_;
      smaller(room.above, lead - ahead).store(room.above);
      smaller(room.below, lead + ahead).store(room.below);
    } else {
      const R on = R(measured.dq) * R(seconds<T>(longest_)), zero = T(0);
      (R(room.above) - select(on < zero, on, zero)).store(room.above);
      (R(room.below) + select(on > zero, on, zero)).store(room.below);
    }
    return room;
  }

  /// Whether a motion within the limits leads from the last command to `wish` in `dt`, and leaves room to
  /// stop or brakes with the full acceleration limit.
  SKINCTL_INLINE bool can_reach(const JointCommand<N, T>& last, const JointCommand<N, T>& wish,
                                const State<N, T>& measured, const T& dt, Status& status) const noexcept {
    using R = Row<N, T>;
    const auto left = room(measured, wish.position);
    const R eps = std::numeric_limits<T>::epsilon(), wide = slack(), zero = T(0);
    const R limit = limits_.velocity(), a = limits_.acceleration(), above = left.above, below = left.below;
    const R u0 = last.velocity, u = wish.velocity, du = u - u0, from = last.position, to = wish.position;
    const R q = magnitude(to) + magnitude(from), rounding = T(16) * eps * q;
    const R most = a * R(T(dt * slack())) + T(4) * eps * limit;
    auto steps = (magnitude(u) > limit * wide) & (magnitude(u) > magnitude(u0));
    steps = steps | (magnitude(du) > most);
    const R stop = T(T(1) / slack()) * limits_.stopping_distance(u) - T(16) * eps * (R(T(1)) + q);
    const auto rushes = !(magnitude(u) <= magnitude(u0) - (T(2) * a * R(dt) - most));
    auto outside = rushes & (((u > zero) & (stop > above)) | ((u < zero) & (stop > below)));
    if constexpr (takes_position(Ix)) {
      // Within its acceleration limit, a joint reaches this far to both sides of the position of the mean
      // speed.
      const R moved = to - from, straight = R(T(T(0.5) * dt)) * (u0 + u);
      const R aside = T(0.25) * (a * R(T(dt * dt * slack()))) - T(0.5) * limits_.stopping_distance(du);
      steps = steps | (magnitude(moved - straight) > select(aside > zero, aside, zero) + rounding);
      outside =
          outside | ((above < -rounding) & (moved > rounding)) | ((below < -rounding) & (-moved > rounding));
    }
    const bool too_far = any(steps), beyond = any(outside);
    if (too_far) status |= Reason::step_limited;
    if (beyond) status |= Reason::outside_limits;
    return !too_far && !beyond;
  }

  JointLimits<N, T> limits_;
  Nanoseconds period_, longest_;
  JointPosition<N, T> lead_;  ///< largest distance of a command from the measured position [rad], [m]
};

}  // namespace detail
SKINCTL_END_NAMESPACE
