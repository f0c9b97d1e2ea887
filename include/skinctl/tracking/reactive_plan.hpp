// SPDX-License-Identifier: BSD-3-Clause
// A target from a sensor, at any rate and with any jumps, sections 4.2.1 and 4.2.5: "reactive trajectories".
#pragma once

#include "skinctl/law/evaluate.hpp"
#include "skinctl/tracking/settings.hpp"
#include "skinctl/trajectory/plan_clock.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The last sample of a sensor, and the smooth motion that follows it; trivially copyable.
///
/// Whatever the samples do, the reference keeps below the speed, acceleration and jerk of the settings (see
/// `Pursuit`), so it needs no reset: `receive` takes a sample like `follow`, and the law's time base and
/// integrals go on. The reference meets a moving target with its velocity. A target that is not finite is
/// refused and the last one kept (`Reason::goal_refused`); one that is too fast is followed at the limits
/// (`Reason::goal_stretched`). When no sample comes for `target_age`, the target stops at its extrapolated
/// place.
template <class Space>
struct ReactivePlan {
  using T = typename Space::scalar;
  using Goal = typename Space::Reference;
  using Settings = typename Space::Settings;
  using Where = typename Space::Where;
  static constexpr const char* name = "reactive";  ///< name of the law
  static constexpr bool streams = true, reacts = true, is_movable = false;

  Goal target;          ///< target as received
  Nanoseconds age{};    ///< time since the target was received
  bool stands = false;  ///< the skin pushes against the law: the reference comes to rest
  Goal reference;       ///< reference that the law follows

  [[nodiscard]] static ReactivePlan standing(const Where& at, const Settings&) noexcept {
    return {Goal{at, {}, {}}, 0ns, false, Goal{at, {}, {}}};
  }
  /// The reference `x` seconds from now, for x up to one interval between cycles.
  [[nodiscard]] Goal at(const T& x, const Settings&) const noexcept { return Space::ahead(reference, x); }
  [[nodiscard]] ReactivePlan advanced(Nanoseconds dt, const Settings& s) const noexcept {
    ReactivePlan next = *this;
    next.age = later(age, dt);
    const T step = seconds<T>(dt);
    if (!(step > T(0))) return next;
    // The target is extrapolated for its age, then stops.
    const Nanoseconds most = Space::tracking(s).target_age;
    const T t = seconds<T>(age < most ? age : most);
    Goal now = Space::ahead(Space::drifting(target), t);
    if (age >= most || stands) now = Space::resting(now);
    if (stands) now = Space::resting(reference);
    Space::react(next.reference, now, s, step);
    return next;
  }
  [[nodiscard]] bool leads_to(const Goal&, const Settings&) const noexcept { return true; }
  [[nodiscard]] ReactivePlan held(bool holds, const Settings&) const noexcept {
    ReactivePlan next = *this;
    next.stands = holds;
    return next;
  }
  /// The plan whose reference goes on from the motion `now`.
  [[nodiscard]] ReactivePlan resumed(const Goal& now, const Settings&) const noexcept {
    return {target, age, false, now};
  }
  [[nodiscard]] Received<ReactivePlan> to(const Goal& goal, const Where&, const Settings& s) const noexcept {
    if (!Space::finite(goal)) return {*this, Reason::goal_refused};
    ReactivePlan next = *this;
    next.target = goal;
    next.age = 0ns;
    return {next, Space::allows(goal, s) ? Status{} : Status(Reason::goal_stretched)};
  }
};

SKINCTL_END_NAMESPACE
