// The part of JointTracking that runs in every cycle.
#pragma once

#include "skinctl/control/joint_tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What the surface reads `x` seconds from now, the integrals going on at the given rates.
template <std::size_t N, Real T, class Plan, class Damping>
SKINCTL_NOINLINE SurfaceInputs<N, T> JointTracking<N, T, Plan, Damping>::inputs(
    const Memory& memory, const T& x, const JointVelocity<N, T>& dI1,
    const JointVelocity<N, T>& dI2) const noexcept {
  using R = detail::Row<N, T>;
  // Built in place: a copy of what has just been written in other pieces waits for them.
  return {memory.held,
          gain(memory, x),
          memory.plan.at(x, settings_),
          memory.bias.at(x, settings_.kappa, settings_.hand_over),
          JointVelocity<N, T>(R(memory.I1.sum) + x * R(dI1)),
          JointVelocity<N, T>(R(memory.I2.sum) + x * R(dI2))};
}

/// The memory `dt` seconds later.
template <std::size_t N, Real T, class Plan, class Damping>
SKINCTL_INLINE TrackingMemory<N, T, Plan> JointTracking<N, T, Plan, Damping>::stepped(
    const Memory& memory, const Surface& at_t, const T& dt) const noexcept {
  const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
  return {later(memory.since_reset, ns),
          memory.held,
          memory.plan.advanced(ns, settings_),
          memory.bias.advanced(dt, ns, settings_.kappa),
          memory.I1.advanced(at_t.dI1, dt),
          memory.I2.advanced(at_t.dI2, dt),
          memory.tb,
          memory.K_from};
}

/// With `K_d = lambda M` feedback and feed-forward go through one recursion, which is linear in them:
/// reference velocity `ff dq_r`, reference acceleration `ff ddq_r - fb lambda S_q`, gravity `ff g`.
template <std::size_t N, Real T, class Plan, class Damping>
template <GravityTerm G, class K>
SKINCTL_INLINE JointTorque<N, T> JointTracking<N, T, Plan, Damping>::torque(
    const Memory& memory, const K& known, const Share<T>& share, const Surface& at_t) const noexcept {
  using M = typename K::model_type;
  using R = detail::Row<N, T>;
  const T h = T(0.5) * known.dt();
  const R damped(damping_.acceleration(known, at_t.S_q));
  const R a = at_t.ddq_r - damped;
  const R q = known.q() + h * (known.dq() + T(T(0.5) * h) * a), dq = known.dq() + h * a;
  const auto ahead = inputs(memory, h, at_t.dI1, at_t.dI2);
  const auto middle = sliding_surface(gains_, ahead, JointPosition<N, T>(q), JointVelocity<N, T>(dq));
  // The acceleration that is held is the one asked for at the middle: the state there once more, with it.
  const R dv = h * (middle.ddq_r - damped - a), dx = T(T(0.5) * h) * dv;
  const JointPosition<N, T> q_h(q + dx);
  const JointVelocity<N, T> dq_h(dq + dv);
  const R v_r = share.feed_forward * (middle.dq_r - ahead.K_p.K * dx);
  R a_r = share.feed_forward * (middle.ddq_r - ahead.K_p.K * dv - ahead.K_p.dK * dx);
  constexpr bool inertial = std::same_as<Damping, InertialDamping<T>>;
  if constexpr (inertial) a_r = a_r - share.feedback * damped;
  const auto& shape = settings_.shape;
  const R decayed = a_r + shape.decay * v_r;
  const R shaped = shape.viscous * v_r + shape.inertia * decayed;  // of rotors and friction
  const JointVelocity<N, T> dq_r(v_r);
  const JointAcceleration<N, T> ddq_r(decayed);
  JointTorque<N, T> tau;
  const JointAngles<M, T> angles(known.model(), q_h);
  const auto run = [&](const auto& a0) SKINCTL_INLINE_LAMBDA {
    detail::run_recursion<T>(known.model(), angles, detail::Values<T>{dq_h.data},
                             detail::Values<T>{dq_r.data}, detail::Values<T>{ddq_r.data}, a0, tau.data);
  };
  if constexpr (G == GravityTerm::included) {
    run(T(-share.feed_forward) * known.model().template gravity<T>());
  } else {
    run(ZeroTriple{});
  }
  (tau + shaped).store(tau);
  if constexpr (!inertial) {
    const auto feedback = damping_.torque(at_t.S_q);
    tau -= share.feedback * feedback;
  }
  return tau;
}

SKINCTL_END_NAMESPACE
