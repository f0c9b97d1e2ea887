// The part of Tracking that runs in every cycle.
#pragma once

#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The inputs of the surface `x` seconds from now, with the integrals going on at the given rates.
template <class Space, class Plan, class Damping>
SKINCTL_INLINE typename Space::Inputs Tracking<Space, Plan, Damping>::inputs_here(
    const Memory& memory, const T& x, const Rates& dI1, const Rates& dI2) const noexcept {
  using R = detail::Row<Space::coordinates, T>;
  // Built in place: a copy right after writes of another width would stall on store forwarding.
  return {memory.plan.at(x, settings_),
          gain(memory, x),
          memory.bias.at(x, decay_, seconds<T>(gains().bumpless_transfer)),
          Rates(R(memory.I1.sum) + x * R(dI1)),
          Rates(R(memory.I2.sum) + x * R(dI2)),
          memory.held};
}

/// The memory `dt` seconds later.
template <class Space, class Plan, class Damping>
SKINCTL_INLINE TrackingMemory<Space, Plan> Tracking<Space, Plan, Damping>::stepped(
    const Memory& memory, const Surface& at_t, const T& dt) const noexcept {
  const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
  return {later(memory.since_reset, ns),
          memory.held,
          memory.plan.advanced(ns, settings_),
          memory.bias.advanced(dt, ns, decay_),
          memory.I1.advanced(at_t.dI1, dt),
          memory.I2.advanced(at_t.dI2, dt),
          memory.tb,
          memory.K_from,
          space_.advanced(memory.space, at_t, dt)};
}

/// With `K_d = lambda M` feedback and feed-forward go through one recursion, which is linear in them:
/// reference velocity `ff dq_r`, reference acceleration `ff ddq_r - fb lambda S_q`, gravity `ff g`.
template <class Space, class Plan, class Damping>
template <GravityTerm G, class K>
SKINCTL_INLINE auto Tracking<Space, Plan, Damping>::torque(const Memory& memory, const K& known,
                                                           const LawShare<T>& share,
                                                           const Surface& at_t) const noexcept
    -> JointTorque<N, T> {
  using M = typename K::model_type;
  using R = detail::Row<N, T>;
  const T h = T(0.5) * known.dt();
  const Middle mid(*this, memory, known, at_t, h);
  const R damped = mid.damped, asked = mid.surface.ddq_r;
  const auto& K_p = mid.inputs.K_p;
  // The held acceleration is the one that the surface gives at the middle: the state there is computed once
  // more with it.
  const R dv = h * (asked - damped - mid.a), dx = T(T(0.5) * h) * dv;
  const JointVelocity<N, T> dq_h(mid.dq + dv);
  const R v_r = share.feed_forward * (mid.surface.dq_r - K_p.K * dx);
  R a_r = share.feed_forward * (asked - K_p.K * dv - K_p.dK * dx);
  constexpr bool inertial = std::same_as<Damping, InertialDamping<T>>;
  if constexpr (inertial) a_r = a_r - share.feedback * damped;
  const auto& shape = gains().virtual_dynamics;
  const R decayed = a_r + shape.damping * v_r;
  const R shaped = shape.viscous * v_r + shape.inertia * decayed;  // of rotors and friction
  const JointVelocity<N, T> dq_r(v_r);
  const JointAcceleration<N, T> ddq_r(decayed);
  JointTorque<N, T> tau;
  const JointAngles<M, T> angles(known.model(), R(mid.q) + dx);
  constexpr bool weighs = G == GravityTerm::included;
  if constexpr (K::carries_bias) {
    detail::BiasBeside<N, T> unasked;
    auto* const beside = known.bias_beside();
    detail::run_recursion_beside<weighs || !K::needs.gravity>(
        known.model(),
        detail::RecursionMotion<JointAngles<M, T>, N, T>{angles, dq_h, dq_r, ddq_r,
                                                         weighs ? share.feed_forward : T(0)},
        tau, known.middle(), K::needs.gravity ? T(0) : T(1), beside != nullptr ? *beside : unasked);
  } else {
    const auto run = [&](const auto& a0) SKINCTL_INLINE_LAMBDA {
      detail::run_recursion<T>(known.model(), angles, detail::Values<T>{dq_h.data},
                               detail::Values<T>{dq_r.data}, detail::Values<T>{ddq_r.data}, a0, tau.data);
    };
    if constexpr (weighs) {
      run(T(-share.feed_forward) * known.model().template gravity<T>());
    } else {
      run(ZeroTriple{});
    }
  }
  (R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return tau[i]; }) + shaped).store(tau);
  if constexpr (!inertial) {
    const auto feedback = damping_.torque(at_t.S_q);
    tau -= share.feedback * feedback;
  }
  return tau;
}

SKINCTL_END_NAMESPACE
