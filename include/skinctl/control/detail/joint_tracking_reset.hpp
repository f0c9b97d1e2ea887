// The part of JointTracking that runs when something begins: a goal, a contact, a release.
#pragma once

#include "skinctl/control/joint_tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The gain from now on, as slow as the largest error asks for.
template <std::size_t N, Real T, class Plan, class Damping>
template <class K>
SKINCTL_COLD Status JointTracking<N, T, Plan, Damping>::begin_gain(Memory& memory,
                                                                   const K& known) const noexcept {
  const auto target = memory.plan.at(T(0), settings_);
  memory.since_reset = 0;
  memory.tb = settings_.tb;
  memory.K_from = schedule_.K_c();
  Status status;
  if (!(memory.tb > T(0))) {
    slow_gain(memory, known);
    return status;
  }
  for (std::size_t i = 0; i < N; ++i) {
    const T speed = settings_.max_velocity[i] - detail::magnitude(target.dq_d[i]);
    if (!(speed > T(0))) continue;
    const T least = schedule_.shortest_time(known.q()[i] - target.q_d[i], speed);
    if (!(least > memory.tb)) continue;
    status |= settings_.reach == Reach::refuse ? Reason::goal_refused : Reason::goal_stretched;
    memory.tb = least;
  }
  return status;
}

/// Without a time base: a gain with which the largest error goes back no faster than `max_velocity`.
template <std::size_t N, Real T, class Plan, class Damping>
template <class K>
SKINCTL_COLD void JointTracking<N, T, Plan, Damping>::slow_gain(Memory& memory,
                                                                const K& known) const noexcept {
  const auto target = memory.plan.at(T(0), settings_);
  memory.tb = T(0);
  memory.K_from = schedule_.K_c();
  for (std::size_t i = 0; i < N; ++i) {
    const T e = detail::magnitude(known.q()[i] - target.q_d[i]);
    if (memory.K_from * e > settings_.max_velocity[i]) memory.K_from = settings_.max_velocity[i] / e;
  }
}

/// `S_d = S`, so that S_delta is zero.
template <std::size_t N, Real T, class Plan, class Damping>
template <class K>
SKINCTL_COLD void JointTracking<N, T, Plan, Damping>::begin_bias(Memory& memory,
                                                                 const K& known) const noexcept {
  const auto target = memory.plan.at(T(0), settings_);
  const auto K_p = gain(memory, T(0));
  memory.bias = {};
  for (std::size_t i = 0; i < N; ++i) {
    memory.bias.decaying[i] = finite(known.dq()[i] - target.dq_d[i] + K_p.K * (known.q()[i] - target.q_d[i]));
  }
}

/// The skin begins or ceases to push against this law. At the release S_d is zero but for the hand-over, and
/// the gain constant: the error goes back on its own side.
template <std::size_t N, Real T, class Plan, class Damping>
template <class K>
SKINCTL_COLD TrackingMemory<N, T, Plan> JointTracking<N, T, Plan, Damping>::switched(
    const Memory& memory, const K& known, const T& dt, Opposition opposition) const noexcept {
  Memory next = memory;
  next.held = opposition == Opposition::lasting;
  next.plan = memory.plan.held(next.held, settings_);
  if (!next.held) {
    next.since_reset = 0;
    slow_gain(next, known);
    next.bias.decaying = {};
  }
  hand_over(next, memory, known);
  return stepped(next, look(next, known), dt);
}

/// Makes the reference of `next` go on from that of `before` at this state, in velocity and acceleration.
template <std::size_t N, Real T, class Plan, class Damping>
template <class K>
SKINCTL_COLD void JointTracking<N, T, Plan, Damping>::hand_over(Memory& next, const Memory& before,
                                                                const K& known) const noexcept {
  const auto old = look(before, known);
  next.bias.elapsed = clock_end;
  const auto raw = look(next, known);
  next.bias.elapsed = 0;
  next.bias.da = {};
  for (std::size_t i = 0; i < N; ++i) next.bias.dv[i] = finite(old.dq_r[i] - raw.dq_r[i]);
  const auto moved = look(next, known);  // dv is part of S_delta, which the integrals of ddq_r read
  for (std::size_t i = 0; i < N; ++i) next.bias.da[i] = finite(old.ddq_r[i] - moved.ddq_r[i]);
}

SKINCTL_END_NAMESPACE
