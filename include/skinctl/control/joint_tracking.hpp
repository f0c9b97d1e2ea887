// The second-order sliding mode of eqs. (8)-(14) in joint space, for any plan of targets.
#pragma once

#include "skinctl/control/damping.hpp"
#include "skinctl/control/sliding_surface.hpp"
#include "skinctl/core/evaluate.hpp"
#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What a tracking law remembers; trivially copyable.
template <std::size_t N, Real T, class Plan>
struct TrackingMemory {
  Nanoseconds since_reset = 0;
  bool held = false;  ///< the skin pushes against this law: integrals and spline stand still
  Plan plan;
  SurfaceBias<N, T> bias;
  Integrals<N, T> I1;  ///< of S_delta [rad]
  Integrals<N, T> I2;  ///< of tanh(mu S_delta) [s]
  T tb = T(0);         ///< convergence time [s], stretched if need be; 0: no time base
  T K_from = T(0);     ///< without one: the gain at the reset [1/s]
};

/// Tracking in joint space, eqs. (8)-(14): `tau = -K_d S_q + Y_r Theta`, evaluated at the middle of the
/// interval for which it will be held, at the state that the law itself predicts there.
///
/// Every reset (a new goal, the skin that begins or ceases to push against the law) keeps the torque: the
/// reference motion goes on from where it was and reaches its new course after `hand_over` (`SurfaceBias`).
/// In the loop nothing is refused but goals. A state that is not finite gives a torque that is not, for the
/// cycle to drop, and leaves the memory finite.
///
/// @tparam Plan  where targets come from: `SplinePlan` or `TargetPlan`.
template <std::size_t N, Real T, class Plan, class Damping = InertialDamping<T>>
class JointTracking : public Composable {
 public:
  using Memory = TrackingMemory<N, T, Plan>;
  using Goal = typename Plan::Goal;
  using Surface = SlidingSurface<N, T>;
  using Settings = JointControlSettings<N, T>;
  static constexpr Needs needs = Damping::needs;
  static constexpr Role role = Role::tracking;

  /// Throws `ConfigurationError` for settings that cannot work: see `check`.
  explicit JointTracking(const Settings& settings = {})
    requires std::same_as<Damping, InertialDamping<T>>
      : JointTracking(settings, InertialDamping<T>(settings.lambda)) {}
  JointTracking(const Settings& settings, const Damping& damping)
      : settings_(settings),
        damping_(damping),
        gains_(settings),
        schedule_(settings.K_c, settings.base, settings.settle) {
    check(settings, damping.fastest());
  }
  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }

  /// Takes over at the state that is known: the target stands where the robot is, `S_d` takes up its
  /// velocity, S_q is zero.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory memory;
    memory.plan = Plan::standing(known.q(), settings_);
    memory.tb = settings_.tb;
    memory.K_from = schedule_.K_c();
    begin_bias(memory, known);
    return memory;
  }

  /// A new goal: the plan, the time base, the surface and its integrals start again from the state that is
  /// known. Refused or stretched goals: `Reach`.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const Goal& goal) const noexcept {
    const auto planned = memory.plan.to(goal, known.q(), settings_);
    Received<Memory> out{memory, planned.status};
    if (planned.status.has(Reason::goal_refused)) return out;
    out.memory.plan = planned.memory;
    out.status |= begin_gain(out.memory, known);
    if (out.status.has(Reason::goal_refused)) return {memory, out.status};
    out.memory.I1 = Integrals<N, T>();
    out.memory.I2 = Integrals<N, T>();
    begin_bias(out.memory, known);
    hand_over(out.memory, memory, known);
    return out;
  }

  /// The next sample of a target that moves smoothly: time base, surface and integrals go on. A sample
  /// further from where the last one leads than `max_velocity` covers in an interval is taken as a new goal.
  template <class K>
  [[nodiscard]] Received<Memory> follow(const Memory& memory, const K& known, const Goal& goal) const noexcept
    requires(Plan::streams)
  {
    const auto expected = memory.plan.at(T(0), settings_);
    for (std::size_t i = 0; i < N; ++i)
      if (!(detail::magnitude(goal.q_d[i] - expected.q_d[i]) <= settings_.max_velocity[i] * settings_.dt))
        return receive(memory, known, goal);
    const auto planned = memory.plan.to(goal, known.q(), settings_);
    Received<Memory> out{memory, planned.status};
    out.memory.plan = planned.memory;
    return out;
  }

  /// The surface at the state that is known: what `torque` and `advance` share.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Surface now(const Memory& memory, const K& known) const noexcept {
    static_assert(K::joints == N && std::same_as<typename K::scalar, T>, "a law for another robot or scalar");
    return sliding_surface(gains_, inputs(memory, T(0), {}, {}), known.q(), known.dq());
  }

  /// `feedback * (-K_d S_q) + feed_forward * (Y_r Theta)` [N m], for the interval that begins now.
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const Share<T>& share,
                                                        const Surface& at_t) const noexcept;
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const Share<T>& share = {}) const noexcept {
    return torque<G>(memory, known, share, now(memory, known));
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known, const T& dt,
                                              Opposition opposition, const Surface& at_t) const noexcept {
    if ((opposition == Opposition::lasting) != memory.held) [[unlikely]]
      return switched(memory, known, dt, opposition);
    return stepped(memory, at_t, dt);
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known, const T& dt,
                                              Opposition opposition) const noexcept {
    return advance(memory, known, dt, opposition, now(memory, known));
  }

  /// Torque and next memory at once.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<N, T, Memory, 1> evaluate(const Memory& memory, const K& known,
                                                                    const T& dt) const noexcept {
    const auto at_t = now(memory, known);
    const auto tau = torque(memory, known, Share<T>{}, at_t);
    return {tau, advance(memory, known, dt, Opposition::none, at_t), {tau}, status(memory)};
  }
  /// Whether a hand-over goes on, and whether the skin holds the law up.
  [[nodiscard]] SKINCTL_INLINE Status status(const Memory& memory) const noexcept {
    Status s;
    if (memory.bias.hands_over(settings_.hand_over)) s |= Reason::hand_over;
    if (memory.held) s |= Reason::opposed;
    return s;
  }

 private:
  [[nodiscard]] static SKINCTL_INLINE T finite(const T& x) noexcept { return x - x == T(0) ? x : T(0); }
  [[nodiscard]] SKINCTL_INLINE Gain<T> gain(const Memory& memory, const T& x) const noexcept {
    const T t = seconds<T>(memory.since_reset) + x;
    return memory.tb > T(0) ? schedule_.at(t, memory.tb) : schedule_.rising(t, memory.K_from);
  }
  [[nodiscard]] SKINCTL_NOINLINE SurfaceInputs<N, T> inputs(const Memory& memory, const T& x,
                                                            const JointVelocity<N, T>& dI1,
                                                            const JointVelocity<N, T>& dI2) const noexcept;
  [[nodiscard]] SKINCTL_INLINE Memory stepped(const Memory& memory, const Surface& at_t,
                                              const T& dt) const noexcept;
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory switched(const Memory& memory, const K& known, const T& dt,
                                             Opposition opposition) const noexcept;
  /// `now` for what happens rarely: one copy of it.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Surface look(const Memory& memory, const K& known) const noexcept {
    return now(memory, known);
  }
  template <class K>
  SKINCTL_COLD Status begin_gain(Memory& memory, const K& known) const noexcept;
  template <class K>
  SKINCTL_COLD void begin_bias(Memory& memory, const K& known) const noexcept;
  template <class K>
  SKINCTL_COLD void slow_gain(Memory& memory, const K& known) const noexcept;
  template <class K>
  SKINCTL_COLD void hand_over(Memory& next, const Memory& before, const K& known) const noexcept;

  Settings settings_;
  Damping damping_;
  SurfaceGains<T> gains_;
  GainSchedule<T> schedule_;
};

SKINCTL_END_NAMESPACE

#include "skinctl/control/detail/joint_tracking_loop.hpp"
#include "skinctl/control/detail/joint_tracking_reset.hpp"
