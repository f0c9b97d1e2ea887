// SPDX-License-Identifier: BSD-3-Clause
// The part of Tracking that runs at a reset: a goal, a contact, a release.
#pragma once

#include "skinctl/tracking/detail/thresholds.hpp"
#include "skinctl/tracking/detail/tracking_loop.hpp"
#include "skinctl/tracking/spline_plan.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The gain, the surface and the bumpless transfer at a reset of a `Tracking`.
template <class Space, class Plan, class Damping>
class TrackingReset : public TrackingLoop<Space, Plan, Damping> {
  using Loop = TrackingLoop<Space, Plan, Damping>;

 public:
  using scalar = typename Loop::scalar;
  using T = typename Loop::T;
  using Memory = typename Loop::Memory;
  using Surface = typename Loop::Surface;

 protected:
  using Loop::finite;
  using Loop::gain;
  using Loop::gains;
  using Loop::gains_;
  using Loop::inputs_called;
  using Loop::no_rates;
  using Loop::schedule_;
  using Loop::settings_;
  using Loop::space_;
  using Loop::stepped;
  using Loop::TrackingLoop;
  using Middle = typename Loop::Middle;

  /// Begins the gain anew, as slow as the largest error needs; the status says if it is stretched or refused.
  template <class K>
  SKINCTL_COLD Status begin_gain(Memory& memory, const K& known) const noexcept {
    memory.since_reset = 0ns;
    memory.tb = seconds<T>(gains().tb);
    memory.K_from = schedule_.K_c();
    Status status;
    if (!(memory.tb > T(0))) {
      slow_gain(memory, known);
      return status;
    }
    const auto error = space_.errors(memory.plan.at(T(0), settings_), space_.site(known), memory.space);
    const T least = schedule_.shortest_time(Space::slowness(error, settings_), T(1));
    if (least > memory.tb) {
      status |= gains().reach == GoalPolicy::refuse ? Reason::goal_refused : Reason::goal_stretched;
      memory.tb = least;
    }
    return status;
  }
  /// The shortest time of a spline to `goal` within the joints' accelerations, by the Jacobian where it
  /// begins [s].
  template <class Site, class Goal>
  [[nodiscard]] SKINCTL_COLD T time_to_accelerate(const Memory& memory, const Site& site,
                                                  const Goal& goal) const noexcept {
    const auto end = SplinePlan<Space>::standing(Space::place(goal), settings_).at(T(0), settings_);
    const auto error = space_.errors(end, site, Space::renewed(memory.space));
    JointVelocity<Space::coordinates, T> way;
    for (std::size_t i = 0; i < Space::coordinates; ++i) way[i] = -error.e[i];
    const auto turns = space_.joint_speed(way, site, memory.space);  // in a second
    T most(0);
    for (std::size_t i = 0; i < Space::joints; ++i) {
      const T share = magnitude(turns[i]) / gains().joint_acceleration[i];
      if (share > most) most = share;
    }
    using std::sqrt;
    return sqrt(quintic_peak_acceleration<T> * most);
  }
  /// Sets, without a time base, a gain at which the largest error decays no faster than `max_velocity`.
  template <class K>
  SKINCTL_COLD void slow_gain(Memory& memory, const K& known) const noexcept {
    memory.tb = T(0);
    memory.K_from = schedule_.K_c();
    auto error = space_.errors(memory.plan.at(T(0), settings_), space_.site(known), memory.space);
    for (T& v : error.v_d) v = T(0);
    const T time = Space::slowness(error, settings_);
    if (memory.K_from * time > T(1)) memory.K_from = T(1) / time;
  }
  /// Begins the bias with `S_d = S`, so that S_delta is zero.
  template <class K>
  SKINCTL_COLD void begin_bias(Memory& memory, const K& known) const noexcept {
    const auto error = space_.errors(memory.plan.at(T(0), settings_), space_.site(known), memory.space);
    const auto K_p = gain(memory, T(0));
    memory.bias = {};
    for (std::size_t i = 0; i < Space::coordinates; ++i)
      memory.bias.decaying[i] = finite(error.de[i] + K_p.K * error.e[i]);
  }
  /// The memory after the skin has begun or ceased to push against this law. At the release S_d is zero but
  /// for the bumpless transfer, and the gain is constant: the error decays without changing its sign.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory switched(const Memory& memory, const K& known, const T& dt,
                                             Opposition opposition) const noexcept {
    Memory next = memory;
    next.held = opposition == Opposition::lasting;
    next.plan = memory.plan.held(next.held, settings_);
    if (!next.held) {
      next.since_reset = 0ns;
      next.space = Space::renewed(next.space);
      slow_gain(next, known);
      next.bias.decaying = {};
    }
    bumpless_transfer(next, memory, known);
    return stepped(next, look(next, known), dt);
  }
  /// Makes the reference of `next` continue that of `before` at this state: in velocity, in acceleration, and
  /// in the change of acceleration until the middle of the interval, where the torque reads it. The last is
  /// left out where `before` is at rest: a plan begins as smoothly as it was planned, and arrives in time.
  template <class K>
  SKINCTL_COLD void bumpless_transfer(Memory& next, const Memory& before, const K& known) const noexcept {
    auto& bias = next.bias;
    const auto old = look(before, known);
    bias.elapsed = clock_end;
    const auto raw = look(next, known);
    bias.elapsed = 0ns;
    bias.da = bias.dj = {};
    for (std::size_t i = 0; i < Space::coordinates; ++i)
      bias.dv[i] = finite(space_.course(old).v[i] - space_.course(raw).v[i]);
    const auto moved = look(next, known);  // dv is part of S_delta, which the integrals of ddq_r read
    for (std::size_t i = 0; i < Space::coordinates; ++i)
      bias.da[i] = finite(space_.course(old).a[i] - space_.course(moved).a[i]);
    const T bend = bias.bend(T(T(0.5) * known.dt()), seconds<T>(gains().bumpless_transfer));
    T fastest(0);  // [rad/s, m/s]
    for (std::size_t i = 0; i < Space::coordinates; ++i)
      if (magnitude(space_.course(old).v[i]) > fastest) fastest = magnitude(space_.course(old).v[i]);
    if (!(bend > T(0)) || !(fastest > T(standing_speed))) return;
    const auto soon = look_ahead(before, known, old), here = look_ahead(next, known, look(next, known));
    for (std::size_t i = 0; i < Space::coordinates; ++i)
      bias.dj[i] = finite((space_.course(soon).a[i] - space_.course(here).a[i]) / bend);
  }
  /// The surface at the known state, and at the middle of the interval, for rare calls: one copy of each.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Surface look(const Memory& memory, const K& known) const noexcept {
    return space_.surface(gains_, inputs_called(memory, T(0), no_rates, no_rates), space_.site(known),
                          memory.space);
  }
  template <class K>
  [[nodiscard]] SKINCTL_COLD Surface look_ahead(const Memory& memory, const K& known,
                                                const Surface& at_t) const noexcept {
    return Middle(*this, memory, known, at_t, T(T(0.5) * known.dt()), std::false_type{}).surface;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
