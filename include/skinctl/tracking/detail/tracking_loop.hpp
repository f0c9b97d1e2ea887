// SPDX-License-Identifier: BSD-3-Clause
// The part of Tracking that runs in every cycle.
#pragma once

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/robot/detail/held_friction.hpp"
#include "skinctl/tracking/damping.hpp"
#include "skinctl/tracking/joint_space.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The memory of a tracking law; trivially copyable.
template <class Space, class Plan>
struct TrackingMemory {
  using T = typename Space::scalar;
  Nanoseconds since_reset{};
  bool held = false;  ///< the skin pushes against this law: integrals and spline are stopped
  Plan plan;
  SurfaceBias<Space::coordinates, T> bias;
  Integrals<Space::coordinates, T> I1;  ///< integral of S_delta
  Integrals<Space::coordinates, T> I2;  ///< integral of tanh(mu S_delta) [s]
  IntegralsUsed<Space::coordinates, T> used;
  T tb = T(0);      ///< convergence time [s], stretched if need be; 0: no time base
  T K_from = T(0);  ///< gain at the reset, without a time base [1/s]
  [[no_unique_address]] typename Space::Memory space = {};  ///< memory of the space
};

namespace detail {

/// The configuration of a `Tracking`, its surface, and its torque.
template <class Space, class Plan, class Damping>
class TrackingLoop : public Composable {
 public:
  static constexpr std::size_t N = Space::joints;
  static constexpr std::size_t joints = N;
  static constexpr std::size_t coordinates = Space::coordinates;
  using scalar = typename Space::scalar;
  using T = typename Space::scalar;
  using Memory = TrackingMemory<Space, Plan>;
  using Goal = typename Plan::Goal;
  using Surface = typename Space::Surface;
  using Settings = typename Space::Settings;
  static constexpr Needs needs = Damping::needs | Space::needs;
  static constexpr LawRole role = LawRole::tracking;
  static constexpr const char* name = Plan::name;

  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
  [[nodiscard]] const Space& space() const noexcept { return space_; }

  /// The surface at the known state: shared by `torque` and `advance`.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Surface now(const Memory& memory, const K& known) const noexcept {
    static_assert(K::joints == N && std::same_as<typename K::scalar, T>, "a law for another robot or scalar");
    return space_.surface(gains_, inputs(memory, T(0), no_rates, no_rates), space_.site(known), memory.space);
  }
  /// Torque of the law, `feedback * (-K_d S_q) + feed_forward * (Y_r Theta)` [N m], for the interval that
  /// begins now.
  ///
  /// With `K_d = lambda M` feedback and feed-forward go through one recursion, which is linear in them:
  /// reference velocity `ff dq_r`, reference acceleration `ff ddq_r - fb lambda S_q`, gravity `ff g`.
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const LawShare<T>& share,
                                                        const Surface& at_t) const noexcept {
    using M = typename K::model_type;
    using R = Row<N, T>;
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
    const JointVelocity<N, T> dq_r(v_r);
    const JointAcceleration<N, T> ddq_r(decayed);
    JointTorque<N, T> tau;
    const JointAngles<M, T> angles(known.model(), JointPosition<N, T>(R(mid.q) + dx));
    const R shaped = R(added_friction<K>(known.model(), angles, dq_r)) + shape.inertia * decayed;
    constexpr bool weighs = G == GravityTerm::included;
    const auto run = [&](const auto& a0) SKINCTL_INLINE_LAMBDA {
      run_recursion<T>(known.model(), angles, Values<T>{dq_h.data}, Values<T>{dq_r.data},
                       Values<T>{ddq_r.data}, a0, tau.data);
    };
    if constexpr (weighs) {
      run(T(-share.feed_forward) * known.model().template gravity<T>());
    } else {
      run(ZeroTriple{});
    }
    (R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return tau[i]; }) + shaped).store(tau);
    if constexpr (!inertial) {
      const auto feedback = damping_.torque(at_t.S_q);
      tau -= share.feedback * feedback;
    }
    return tau;
  }

 protected:
  TrackingLoop(const Space& space, const Settings& settings, const Damping& damping)
      : space_(space),
        settings_(settings),
        damping_(damping),
        gains_(Space::tracking(settings)),
        schedule_(gains().K_c, gains().base, gains().settle),
        decay_(gains().kappa, seconds<T>(gains().dt)) {
    check(gains(), damping.fastest());
    check_gravity(gains(), damping.slowest(), gains().gravity_rate);
  }

  [[nodiscard]] static SKINCTL_INLINE T finite(const T& x) noexcept { return x - x == T(0) ? x : T(0); }
  /// The torque [N m] that the robot's added friction takes at the speed `v`: of a virtual robot B v, B its
  /// viscous friction, of a real one as much as its delay allows, see `held_friction`. With B v a loop of 20
  /// ms ran away.
  template <class K, class M, class Angles>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> added_friction(const M& model, const Angles& angles,
                                                                const JointVelocity<N, T>& v) const noexcept {
    using R = Row<N, T>;
    const auto& shape = gains().virtual_dynamics;
    if constexpr (!K::is_virtual)
      if (any(R(shape.viscous) > R(T(0)))) {
        auto mass = mass_matrix(model, angles);
        for (std::size_t i = 0; i < N; ++i) mass(i, i) = mass(i, i) + shape.inertia[i];
        return held_friction<AllJoints<N>>(shape.viscous, mass, v, seconds<T>(gains().delay_in_loop()));
      }
    return JointTorque<N, T>(shape.viscous * R(v));
  }
  [[nodiscard]] SKINCTL_INLINE Gain<T> gain(const Memory& memory, const T& x) const noexcept {
    const T t = seconds<T>(memory.since_reset) + x;
    return memory.tb > T(0) ? schedule_.at(t, memory.tb) : schedule_.rising(t, memory.K_from);
  }
  [[nodiscard]] SKINCTL_INLINE const JointControlSettings<N, T>& gains() const noexcept {
    return Space::tracking(settings_);
  }
  /// The memory `dt` seconds later.
  [[nodiscard]] SKINCTL_INLINE Memory stepped(const Memory& memory, const Surface& at_t,
                                              const T& dt) const noexcept {
    const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
    return {later(memory.since_reset, ns),
            memory.held,
            memory.plan.advanced(ns, settings_),
            memory.bias.advanced(dt, ns, decay_),
            memory.I1.advanced(at_t.dI1, dt),
            memory.I2.advanced(at_t.dI2, dt),
            {},
            memory.tb,
            memory.K_from,
            space_.advanced(memory.space, at_t, dt)};
  }
  using Rates = JointVelocity<Space::coordinates, T>;
  static inline const Rates no_rates{};
  /// Keeps the integrals of `next` within their limit, in joint torque, or in speed of a virtual robot.
  template <class K>
  SKINCTL_INLINE void bound_integrals(Memory& next, const K& known) const noexcept {
    using R = detail::Row<Space::coordinates, T>;
    const R first = gains_.K_i1 * R(next.I1.sum), second = gains_.K_i2 * R(next.I2.sum);
    const R free = K::is_virtual ? T(T(0.5) * gains().integral_speed) : T(0);
    if (any(magnitude(first) > free) || any(magnitude(second) > free)) [[unlikely]]
      bound_integrals(next, known, Rates(first + second));
  }
  template <class K>
  SKINCTL_NOINLINE void bound_integrals(Memory& next, const K& known,
                                        [[maybe_unused]] const Rates& asked) const noexcept {
    [[maybe_unused]] const auto& limit = gains().integral_limit;
    if constexpr (K::is_virtual) {
      for (std::size_t i = 0; i < Space::coordinates; ++i)
        next.used.I1[i] = gains_.used(T(gains_.K_i1 * next.I1.sum[i]), gains().integral_speed),
        next.used.I2[i] = gains_.used(T(gains_.K_i2 * next.I2.sum[i]), gains().integral_speed);
    } else {
      const auto& shape = gains().virtual_dynamics;
      const JointVelocity<N, T> v = space_.joint_speed(asked, space_.site(known), next.space);
      auto load = damping_.torque(known, shape.inertia, v);
      for (std::size_t i = 0; i < N; ++i) {
        load.torque[i] = load.torque[i] + shape.viscous[i] * v[i];
        load.own[i] = load.own[i] + shape.viscous[i];
      }
      if constexpr (Space::of_joints) {
        for (std::size_t i = 0; i < N; ++i) bound_joint(next, i, load.torque[i], load.own[i], limit[i]);
      } else {
        bound_together(next, asked, load.torque, limit);
      }
    }
  }
  /// Takes back what is beyond the limit of one joint; the others see to theirs, so that the torques settle
  /// within a few evaluations, as Gauss and Seidel solve `|K_d v| <= limit`.
  SKINCTL_INLINE void bound_joint(Memory& next, std::size_t i, const T& torque, const T& own,
                                  const T& limit) const noexcept {
    next.used.I1[i] = next.used.I2[i] = gains_.used(torque, limit);
    const T beyond = magnitude(torque) - limit;
    if (!(beyond > T(0) && beyond - beyond == T(0) && own > T(0))) return;
    const T less = (torque < T(0) ? beyond : T(-beyond)) / own;
    const bool first = gains_.K_i1 > T(0);
    T& sum = first ? next.I1.sum[i] : next.I2.sum[i];
    sum = sum + less / (first ? gains_.K_i1 : gains_.K_i2);
  }
  /// Bounds all coordinates alike, by the joint that is nearest to its limit: each coordinate moves all
  /// joints.
  SKINCTL_INLINE void bound_together(Memory& next, const Rates& asked, const JointTorque<N, T>& torque,
                                     const JointTorque<N, T>& limit) const noexcept {
    T most(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T share = magnitude(torque[i]) / limit[i];
      if (share > most) most = share;
    }
    if (!(most - most == T(0))) return;
    const T part = gains_.used(most, T(1));
    for (std::size_t c = 0; c < Space::coordinates; ++c) {
      next.used.I1[c] = next.used.I2[c] = asked[c] < T(0) ? T(-part) : part;
      if (most > T(1)) next.I1.sum[c] = next.I1.sum[c] / most, next.I2.sum[c] = next.I2.sum[c] / most;
    }
  }
  /// The middle of the interval, as the law predicts it. Built in place: a copy in other pieces than it was
  /// written in would have to wait for them.
  struct Middle {
    using R = Row<N, T>;
    template <class K, bool Brief = Space::brief>
    SKINCTL_INLINE Middle(const TrackingLoop& law, const Memory& memory, const K& known, const Surface& at_t,
                          const T& h, std::bool_constant<Brief> = {}) noexcept
        : damped(law.damping_.acceleration(known, at_t.S_q)),
          a(at_t.ddq_r - damped),
          q(known.q() + h * (known.dq() + T(T(0.5) * h) * a)),
          dq(known.dq() + h * a),
          inputs(law.template inputs<Brief>(memory, h, at_t.dI1, at_t.dI2)),
          surface(
              law.space_.surface(law.gains_, inputs, law.space_.site(known.model(), q, dq), memory.space)) {}

    R damped;  ///< `M^-1 K_d S_q`
    R a;       ///< `ddq_r - damped`, both at the beginning of the interval
    JointPosition<N, T> q;
    JointVelocity<N, T> dq;
    typename Space::Inputs inputs;
    Surface surface;
  };
  /// The inputs of the surface, inlined where a call costs much of what the law costs; elsewhere one copy for
  /// all.
  template <bool Brief = Space::brief>
  [[nodiscard]] SKINCTL_INLINE typename Space::Inputs inputs(const Memory& memory, const T& x,
                                                             const Rates& dI1,
                                                             const Rates& dI2) const noexcept {
    if constexpr (Brief) {
      return inputs_here(memory, x, dI1, dI2);
    } else {
      return inputs_called(memory, x, dI1, dI2);
    }
  }
  /// The inputs of the surface `x` seconds from now, with the integrals going on at the given rates.
  [[nodiscard]] SKINCTL_INLINE typename Space::Inputs inputs_here(const Memory& memory, const T& x,
                                                                  const Rates& dI1,
                                                                  const Rates& dI2) const noexcept {
    using R = detail::Row<Space::coordinates, T>;
    // Built in place: a copy right after writes of another width would stall on store forwarding.
    return {memory.plan.at(x, settings_),
            gain(memory, x),
            memory.bias.at(x, decay_, seconds<T>(gains().bumpless_transfer)),
            Rates(R(memory.I1.sum) + x * R(dI1)),
            Rates(R(memory.I2.sum) + x * R(dI2)),
            memory.used,
            memory.held};
  }
  [[nodiscard]] SKINCTL_NOINLINE typename Space::Inputs inputs_called(const Memory& memory, const T& x,
                                                                      const Rates& dI1,
                                                                      const Rates& dI2) const noexcept {
    return inputs_here(memory, x, dI1, dI2);
  }

  [[no_unique_address]] Space space_;
  Settings settings_;
  Damping damping_;
  SurfaceGains<T> gains_;
  GainSchedule<T> schedule_;
  Decay<T> decay_;  ///< decay of the bias
};

}  // namespace detail
SKINCTL_END_NAMESPACE
