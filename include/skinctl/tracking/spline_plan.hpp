// SPDX-License-Identifier: BSD-3-Clause
// A static goal, reached along a spline, sections 4.2.4 and 4.2.5.
#pragma once

#include <cmath>
#include <limits>

#include "skinctl/law/evaluate.hpp"
#include "skinctl/tracking/settings.hpp"
#include "skinctl/trajectory/plan_clock.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A spline to a goal, with its clock, in the coordinates of `Space`; trivially copyable.
template <class Space>
struct SplinePlan {
  using T = typename Space::scalar;
  using Goal = typename Space::Goal;
  using Settings = typename Space::Settings;
  using Where = typename Space::Where;
  static constexpr bool streams = false, reacts = false, is_movable = false;
  static constexpr const char* name = Space::spline_name;  ///< name of the law
  /// Slowest pace of a plan that waits, as a share of its full one: a plan held back by joints' droop still
  /// ends.
  static constexpr double slowest = 0.1;
  /// Longest time between goals that are samples of one motion, over `target_age`: one may be lost.
  static constexpr int sample_gap = 2;
  /// Largest step of the reference's velocity at a sample, as a share of the largest velocity; a larger one
  /// is ramped out as at a new goal.
  static constexpr double smooth_step = 0.02;
  /// Shortest spline, in intervals `dt`: fewer do not show its shape.
  static constexpr int min_intervals = 10;
  /// Longest spline [s]: its nanoseconds still count, for 30 years.
  static constexpr double longest_time = 1e9;

  typename Space::Spline spline;
  PlanClock<T> clock;
  Nanoseconds asked{};            ///< duration that the last goal asked for
  Nanoseconds heard = clock_end;  ///< time since the last goal

  /// The plan of a robot at rest at `at`.
  [[nodiscard]] static SKINCTL_INLINE constexpr SplinePlan standing(const Where& at,
                                                                    const Settings&) noexcept {
    return {Space::spline(at, at, T(0)), {}};
  }
  /// Whether `goal` is a sample of a motion: it comes soon after the last goal, and is no further from it
  /// than the largest speed covers meanwhile.
  [[nodiscard]] bool is_sample(const Goal& goal, const Settings& s) const noexcept {
    if (!(heard <= sample_gap * Space::tracking(s).target_age)) return false;
    const auto end = spline.at(std::numeric_limits<T>::infinity());
    const auto moved = Space::distance(standing(Space::place(goal), s).at(T(0), s), end);
    return Space::slowness(moved, s) <= seconds<T>(later(heard, Space::tracking(s).dt));
  }
  /// Whether `goal` is the one that the plan leads to already, or that it is sent again and again.
  [[nodiscard]] bool leads_to(const Goal& goal, const Settings& s) const noexcept {
    return goal.duration == asked &&
           Space::where_of(spline.at(std::numeric_limits<T>::infinity())) == Space::place(goal) &&
           (is_sample(goal, s) || !Space::stands(at(T(0), s)));
  }
  /// Whether the reference goes on from that of `before` without a step of its velocity.
  [[nodiscard]] bool goes_on_from(const SplinePlan& before, const Settings& s) const noexcept {
    const T x = seconds<T>(Space::tracking(s).dt);
    const auto soon = [&](const SplinePlan& plan) {
      return Space::ahead(Space::drifting(plan.at(T(0), s)), x);
    };
    return Space::slowness(Space::distance(soon(*this), soon(before)), s) <= T(smooth_step) * x;
  }
  /// The reference `x` seconds from now.
  [[nodiscard]] SKINCTL_INLINE typename Space::Reference at(const T& x, const Settings& s) const noexcept {
    const auto own = clock.at(x, Space::tracking(s).bumpless_transfer);
    auto r = spline.at(own.t);
    Space::slow(r, own);
    return r;
  }
  [[nodiscard]] SKINCTL_INLINE constexpr SplinePlan advanced(Nanoseconds dt,
                                                             const Settings& s) const noexcept {
    return {spline, clock.advanced(dt, Space::tracking(s).bumpless_transfer), asked, later(heard, dt)};
  }
  /// The plan, which waits for a robot that a limit, an obstacle or a hand keeps off its course: see
  /// `JointControlSettings::waits`.
  /// @param missed  speed by which the robot misses its course, as a share of the largest, >= 0.
  [[nodiscard]] SKINCTL_INLINE constexpr SplinePlan waited(const T& missed, Nanoseconds dt,
                                                           const Settings& s) const noexcept {
    const T most = Space::tracking(s).waits, share = T(2) - T(2) * missed / most;
    if (!(share < T(1)) && clock.pace == T(1)) [[likely]]
      return *this;
    const T wish = share < T(slowest) ? T(slowest) : (share < T(1) ? share : T(1));
    return {spline, clock.paced(wish, dt, Space::tracking(s).bumpless_transfer), asked, heard};
  }
  /// The plan whose spline comes to a stop (`holds`), or goes on.
  [[nodiscard]] SKINCTL_INLINE constexpr SplinePlan held(bool holds, const Settings& s) const noexcept {
    return {spline, clock.changed(!holds, Space::tracking(s).bumpless_transfer), asked, heard};
  }

  /// Whether the largest speed leads from the motion `now` back to the course within a bumpless transfer.
  [[nodiscard]] bool is_near(const typename Space::Reference& now, const Settings& s) const noexcept {
    const T soon = seconds<T>(Space::tracking(s).bumpless_transfer);
    const auto then = [&](const auto& r) { return Space::ahead(Space::drifting(r), soon); };
    return Space::slowness(Space::distance(then(now), then(at(T(0), s))), s) <= soon;
  }
  /// The plan that leads on from the motion `now` to where it led: in the time that it had left, or in so
  /// much more that it asks for no more acceleration than before, `tf sqrt(way left / whole way)`.
  [[nodiscard]] SplinePlan resumed(const typename Space::Reference& now, const Settings& s) const noexcept {
    const Where& where = Space::where_of(now);
    const auto end = spline.at(std::numeric_limits<T>::infinity());
    const auto far = [&](const auto& from) { return Space::slowness(Space::distance(end, from), s); };
    const SplinePlan here = standing(where, s);
    const T whole = far(spline.at(T(0))), way = far(here.at(T(0), s));
    using std::sqrt;
    const T gentle = whole > way ? T(spline.duration() * sqrt(way / whole)) : spline.duration();
    const T left = spline.duration() - seconds<T>(clock.own), time = left > gentle ? left : gentle;
    auto next = here.to(Goal{Space::where_of(end), nanoseconds(static_cast<double>(time))}, where, s);
    if (next.status.has(Reason::goal_refused)) next = here.to(Goal{Space::where_of(end), 0ns}, where, s);
    SplinePlan& out = next.memory;
    out.spline = Space::spline(where, Space::where_of(end), out.spline.duration()).from(now);
    out.asked = asked, out.heard = heard;
    return out;
  }

  /// The plan of a spline from `where` to the goal, of 10 intervals `dt` or longer. Where its peak speed
  /// would exceed the settings' limit it is stretched, or refused. A goal that is not finite is refused. A
  /// plan under way goes on with its velocity and acceleration, as far as they lead towards the new goal.
  /// @param at_least  shortest time for other reasons than the speeds [s].
  [[nodiscard]] Received<SplinePlan> to(const Goal& goal, const Where& where, const Settings& settings,
                                        const T& at_least = T(0)) const noexcept {
    const auto& s = Space::tracking(settings);
    const T shortest = Space::shortest_time(where, goal, settings);
    const T intervals = T(min_intervals) * seconds<T>(s.dt),
            other = at_least > intervals ? at_least : intervals, least = shortest > other ? shortest : other;
    if (!(shortest < T(longest_time)) || goal.duration < 0ns) return {*this, Reason::goal_refused};
    const T time = seconds<T>(goal.duration);
    const PlanClock<T> begun{0ns,      clock_end,  clock.to,
                             clock.to, clock.pace, clock.pace_rate};  // a stopped plan stays stopped
    const auto in = [&](const T& tf) {
      return Space::spline(where, Space::place(goal), tf).from(at(T(0), settings));
    };
    if (time >= least) return {{in(time), begun, goal.duration, 0ns}, {}};
    if (goal.duration > 0ns && s.reach == GoalPolicy::refuse) return {*this, Reason::goal_refused};
    return {{in(least), begun, goal.duration, 0ns},
            goal.duration > 0ns ? Status(Reason::goal_stretched) : Status{}};
  }
};

SKINCTL_END_NAMESPACE
