// SPDX-License-Identifier: BSD-3-Clause
// A target from outside: positions and velocities, sections 4.2.1 and 4.2.2.
#pragma once

#include "skinctl/law/evaluate.hpp"
#include "skinctl/tracking/settings.hpp"
#include "skinctl/trajectory/plan_clock.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The last target received, in the coordinates of `Space`, and its age; trivially copyable.
///
/// A moving target is extrapolated, `q_d + x dq_d + x^2/2 ddq_d`, for `target_age`; then its time slows down
/// over as long again and stops. So a source that falls silent leaves the robot at rest, half of `target_age`
/// further.
template <class Space>
struct TargetPlan {
  using T = typename Space::scalar;
  using Goal = typename Space::Reference;
  using Settings = typename Space::Settings;
  using Where = typename Space::Where;
  static constexpr bool streams = true, reacts = false, is_movable = true;
  static constexpr const char* name = Space::name;  ///< name of the law
  /// Longest time between two samples that count as one motion, in intervals `dt`: a few cycles may be late.
  static constexpr int longest_gap = 4;

  Goal target;
  PlanClock<T> clock;     ///< time since the target was received
  bool is_stale = false;  ///< the target is older than `target_age`, and slows down

  [[nodiscard]] static SKINCTL_INLINE constexpr TargetPlan standing(const Where& at,
                                                                    const Settings&) noexcept {
    return {Goal{at, {}, {}}, {}, false};
  }
  /// The plan of a target just received.
  [[nodiscard]] static SKINCTL_INLINE constexpr TargetPlan moved(const Goal& goal) noexcept {
    return {goal, {}, false};
  }
  /// The target `x` seconds from now.
  [[nodiscard]] SKINCTL_INLINE Goal at(const T& x, const Settings& s) const noexcept {
    const auto own = clock.at(x, Space::tracking(s).target_age);
    auto r = Space::ahead(target, own.t);
    Space::slow(r, own);
    return r;
  }
  [[nodiscard]] SKINCTL_INLINE constexpr TargetPlan advanced(Nanoseconds dt,
                                                             const Settings& s) const noexcept {
    const Nanoseconds age = Space::tracking(s).target_age;
    TargetPlan next{target, clock.advanced(dt, age), is_stale};
    if (!is_stale && next.clock.own >= age) [[unlikely]] {
      next.clock = next.clock.changed(false, age);
      next.is_stale = true;
    }
    return next;
  }
  /// Whether `goal` is within the distance from this target that the largest speed covers since the last one
  /// was received, from `dt` of the settings to `longest_gap` times that.
  [[nodiscard]] bool leads_to(const Goal& goal, const Settings& s) const noexcept {
    const T dt = seconds<T>(Space::tracking(s).dt), gone = seconds<T>(clock.own);
    const T most = T(longest_gap) * dt, time = gone < dt ? dt : (gone > most ? most : gone);
    return Space::slowness(Space::distance(goal, at(T(0), s)), s) <= time;
  }
  /// The plan, unchanged, whether the skin pushes against the law or not: the clock of a target from outside
  /// does not stop.
  [[nodiscard]] SKINCTL_INLINE constexpr TargetPlan held(bool, const Settings&) const noexcept {
    return *this;
  }

  /// The plan, unchanged: its target is one from outside.
  [[nodiscard]] TargetPlan resumed(const Goal&, const Settings&) const noexcept { return *this; }

  /// The plan of a new target. One that is not finite, or faster than the settings allow, is refused.
  [[nodiscard]] Received<TargetPlan> to(const Goal& goal, const Where&, const Settings& s) const noexcept {
    if (!Space::allows(goal, s)) return {*this, Reason::goal_refused};
    return {moved(goal), {}};
  }
};

SKINCTL_END_NAMESPACE
