// The part of Tracking that runs in every cycle.
#pragma once

#include "skinctl/control/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What the surface reads `x` seconds from now, the integrals going on as at `at_t`.
template <class Space, class Plan, class Damping, class Sign>
SKINCTL_NOINLINE typename Space::Inputs Tracking<Space, Plan, Damping, Sign>::inputs(
    const Memory& memory, const T& x, const Surface& at_t) const noexcept {
  // Built in place: a copy of what has just been written in other pieces waits for them.
  typename Space::Inputs in{memory.plan.at(x, settings_),
                            gain(memory, x),
                            memory.bias.at(x, gains().kappa, gains().hand_over),
                            {},
                            {},
                            memory.held,
                            memory.sign.data()};
  detail::for_each_index<Space::coordinates>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    in.I1[i] = memory.I1.sum[i] + x * at_t.dI1[i];
    in.I2[i] = memory.I2.sum[i] + x * at_t.dI2[i];
  });
  return in;
}

/// The memory `dt` seconds later.
template <class Space, class Plan, class Damping, class Sign>
SKINCTL_INLINE TrackingMemory<Space, Plan, Sign> Tracking<Space, Plan, Damping, Sign>::stepped(
    const Memory& memory, const Surface& at_t, const T& dt) const noexcept {
  const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
  return {memory.plan.advanced(ns, settings_),
          memory.bias.advanced(dt, ns, gains().kappa),
          memory.I1.advanced(at_t.dI1, dt),
          memory.I2.advanced(at_t.dI2, dt),
          later(memory.since_reset, ns),
          memory.tb,
          memory.K_from,
          memory.held,
          memory.sign.advanced(at_t.S_delta.data, gains().mu, dt, memory.held),
          space_.advanced(memory.space, at_t, dt)};
}

/// With `K_d = lambda M` feedback and feed-forward go through one recursion, which is linear in them:
/// reference velocity `ff dq_r`, reference acceleration `ff ddq_r - fb lambda S_q`, gravity `ff g`.
template <class Space, class Plan, class Damping, class Sign>
template <GravityTerm G, class K>
SKINCTL_INLINE auto Tracking<Space, Plan, Damping, Sign>::torque(const Memory& memory, const K& known,
                                                                 const Share<T>& share,
                                                                 const Surface& at_t) const noexcept
    -> JointTorque<N, T> {
  using M = typename K::model_type;
  const T h = T(0.5) * known.dt();
  const auto damped = damping_.acceleration(known, at_t.S_q);
  JointPosition<N, T> q_h;
  JointVelocity<N, T> dq_h;
  JointAcceleration<N, T> a;
  for (std::size_t i = 0; i < N; ++i) {
    a[i] = at_t.ddq_r[i] - damped[i];
    q_h[i] = known.q()[i] + h * (known.dq()[i] + T(0.5) * h * a[i]);
    dq_h[i] = known.dq()[i] + h * a[i];
  }
  const auto ahead = inputs(memory, h, at_t);
  const auto middle = space_.surface(gains_, ahead, space_.site(known.model(), q_h, dq_h), memory.space);
  JointVelocity<N, T> dq_r;
  JointAcceleration<N, T> ddq_r;
  JointTorque<N, T> shaped;  // of rotors and friction
  constexpr bool inertial = std::same_as<Damping, InertialDamping<T>>;
  for (std::size_t i = 0; i < N; ++i) {
    // The acceleration that is held is the one asked for at the middle: the state there once more, with it.
    const T dv = h * (middle.ddq_r[i] - damped[i] - a[i]);
    const T dx = T(0.5) * h * dv;
    q_h[i] = q_h[i] + dx;
    dq_h[i] = dq_h[i] + dv;
    dq_r[i] = share.feed_forward * (middle.dq_r[i] - ahead.K_p.K * dx);
    ddq_r[i] = share.feed_forward * (middle.ddq_r[i] - ahead.K_p.K * dv - ahead.K_p.dK * dx);
    if constexpr (inertial) ddq_r[i] = ddq_r[i] - share.feedback * damped[i];
    shaped[i] = gains().shape.viscous[i] * dq_r[i] +
                gains().shape.inertia[i] * (ddq_r[i] + gains().shape.decay * dq_r[i]);
    ddq_r[i] = ddq_r[i] + gains().shape.decay * dq_r[i];
  }
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
  tau += shaped;
  if constexpr (!inertial) {
    const auto feedback = damping_.torque(at_t.S_q);
    for (std::size_t i = 0; i < N; ++i) tau[i] = tau[i] - share.feedback * feedback[i];
  }
  return tau;
}

SKINCTL_END_NAMESPACE
