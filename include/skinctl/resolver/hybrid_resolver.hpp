// An arm by velocity and a hand by torque in one cycle: joints of both kinds moved by one fused torque.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/resolver/detail/held_friction.hpp"
#include "skinctl/resolver/resolver.hpp"
#include "skinctl/robot/hybrid_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Memory of a hybrid resolver. Trivially copyable.
template <std::size_t N, std::size_t Stiff, Real T, std::size_t History>
struct HybridMemory {
  VirtualJointsMemory<Stiff, T, History> stiff;
  State<N, T> measured;        ///< the last good measurement, of all joints
  JointCommand<N, T> command;  ///< the last one
};

/// One robot, one law, one fused torque, and joints of two kinds: those of the set `ByTorque` (driven joints)
/// take torques, the others (stiff joints) positions or velocities (`I`).
///
/// - A law reads one state: the virtual one of the stiff joints, the measured one of the driven joints.
/// - The stiff joints are treated as by `Resolver<I>`: a virtual robot that carries the law's torque,
///   sub-stepped over the interval just passed, with the driven joints as a load at their measured positions:
///   `M_ss dv = tau_s - (C_s v)_s - G_s - B v`. The reaction of the driven joints' motion on the arm is left
///   out: that of a finger that starts and stops (0.2 kg at 50 rad/s^2: half a newton at its knuckle) is zero
///   on average, and half of it, by the velocities without the accelerations, would shake the arm when
///   fingers tremble.
/// - The driven joints are treated as by `Resolver<Interface::torque>`: the law's torque at the newest
///   measurement, for one period from now, less the configured friction, cut to the limits. For it the law is
///   evaluated once more, at the end of the cycle.
/// - A measurement is taken for all joints or for none: one number that is not finite refuses all of it.
///   While the state is stale, or during a stop, the stiff joints brake and hold, and gravity of the driven
///   ones is compensated, with friction (stale: without). While a stiff joint is blocked the driven ones go
///   on.
///
/// A command has both kinds: `stiff(command)` and `torque(command)` are the parts of the two devices, and
/// cannot be mixed up, as their types differ. Parts of `Passivity` are for robots of one kind so far.
template <Interface I, LinkMask ByTorque, RobotModel M, Real T = double, class Integrator = CrankNicolson,
          std::size_t History = 32>
class HybridResolver {
 public:
  static constexpr std::size_t joints = M::joints;
  using Driven = JointSubset<joints, ByTorque>;
  using Stiff = typename Driven::Others;
  static_assert(Driven::count > 0 && Stiff::count > 0, "joints of one kind: Resolver is for these");
  using scalar = T;
  static constexpr Interface stiff_interface = I;
  static constexpr LinkMask by_torque = ByTorque;
  using Configuration = HybridConfiguration<Stiff::count, Driven::count, T>;
  using Memory = HybridMemory<joints, Stiff::count, T, History>;
  template <class L, class Touch = NoTouch>
  using Knows = Quantities<M, L::needs | Integrator::needs, T, Touch, VirtualMass<joints, T>>;

  /// Throws `ConfigurationError` for a number out of its range.
  HybridResolver(const M& model, const Configuration& c)
      : model_(model), virtual_(c.stiff), limits_(c.limits), viscous_(c.viscous) {
    Stiff::put(virtual_.parameters().shape.inertia, inertia_);
    Stiff::put(stiff_limits().torque(), torques_);
    Driven::put(limits_.torque(), torques_);
    for (const T& b : viscous_) {
      has_friction_ = has_friction_ || b > T(0);
      require(b >= T(0) && b <= T(1e6), "viscous friction", static_cast<double>(b), "0 to 1e6 N m s/rad");
    }
  }

  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] const JointLimits<Stiff::count, T>& stiff_limits() const noexcept {
    return virtual_.parameters().limits;
  }
  [[nodiscard]] const JointLimits<Driven::count, T>& torque_limits() const noexcept { return limits_; }
  [[nodiscard]] const auto& parameters() const noexcept { return virtual_.parameters(); }
  /// T = delay + lag + period of the stiff joints [s].
  [[nodiscard]] T total_delay() const noexcept { return virtual_.parameters().total_delay; }
  /// Length of a sub-step in a punctual cycle [s].
  [[nodiscard]] T planned_step() const noexcept { return virtual_.parameters().planned_step(); }

  /// The command of the stiff joints.
  [[nodiscard]] static JointCommand<Stiff::count, T> stiff(const JointCommand<joints, T>& c) noexcept {
    return part_of<Stiff>(c);
  }
  /// The command of the driven joints [N m].
  [[nodiscard]] static JointTorque<Driven::count, T> torque(const JointCommand<joints, T>& c) noexcept {
    return Driven::of(c.torque);
  }

  /// The virtual joints take over at the positions of the real ones; gravity of the driven ones is
  /// compensated. A state that is not finite gives a memory that has not been started.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<joints, T>& measured) const noexcept {
    Memory m;
    if (!detail::is_plausible(measured)) return m;
    m.stiff = virtual_.start(part_of<Stiff>(measured));
    m.measured = measured;
    if (m.stiff.started) compose(m, Driven::of(held(measured)));
    return m;
  }

  /// The state that laws read.
  [[nodiscard]] SKINCTL_INLINE State<joints, T> state(const Memory& m) const noexcept {
    return state(m, m.stiff.time, m.stiff.v);
  }
  /// As `Resolver::known`; the virtual inertia is that of the stiff joints.
  template <class L, class Touch>
  [[nodiscard]] SKINCTL_INLINE Knows<L, Touch> known(const State<joints, T>& state, const T& dt,
                                                     const Touch& touch) const noexcept {
    return Knows<L, Touch>(model_, state, dt, touch, {torques_, inertia_, no_tool_});
  }
  /// The interval that a cycle at `now` has to integrate; empty if `now` is not later than the last cycle.
  [[nodiscard]] Interval interval(const Memory& m, Nanoseconds now) const noexcept {
    return virtual_.interval(m.stiff, now);
  }

  /// One cycle, as `Resolver::step`.
  template <class L, class Touch, class Check = AnyState>
  Resolved<joints, T, terms_of<L>> step(Memory& m, const L& law, typename L::Memory& law_memory,
                                        const State<joints, T>& measured, const Interval& interval,
                                        std::span<const Touch> touches,
                                        const Check& check = {}) const noexcept;

  /// The torque that holds the driven joints without a law: `G(q) - B dq`; zero for the others.
  [[nodiscard]] JointTorque<joints, T> held(const State<joints, T>& robot) const noexcept {
    return held(robot.q, friction(robot));
  }

  /// The guard sent `command` instead of the last one.
  void sent(Memory& m, const JointCommand<joints, T>& command) const noexcept {
    if (!m.stiff.started || !command.valid) return;
    const auto given = stiff(command);
    const auto& asked = m.stiff.command;
    if (!(given.position == asked.position && given.velocity == asked.velocity))
      virtual_.sent(m.stiff, given);
    compose(m, torque(command));
  }

  /// Begins a stop.
  void stop(Memory& m) const noexcept { m.stiff.stop = true; }
  void resume(Memory& m) const noexcept { virtual_.resume(m.stiff); }

  /// The elements of `whole` that belong to the joints of a subset.
  template <class Subset>
  [[nodiscard]] static SKINCTL_INLINE State<Subset::count, T> part_of(
      const State<joints, T>& whole) noexcept {
    return {whole.time, Subset::of(whole.q), Subset::of(whole.dq)};
  }
  template <class Subset>
  [[nodiscard]] static SKINCTL_INLINE JointCommand<Subset::count, T> part_of(
      const JointCommand<joints, T>& whole) noexcept {
    return {whole.time,
            whole.valid,
            Subset::of(whole.position),
            Subset::of(whole.velocity),
            Subset::of(whole.acceleration),
            Subset::of(whole.torque)};
  }

 private:
  using Velocity = JointVelocity<Stiff::count, T>;
  using StiffTorque = JointTorque<Stiff::count, T>;
  using DrivenTorque = JointTorque<Driven::count, T>;

  [[nodiscard]] SKINCTL_INLINE State<joints, T> state(const Memory& m, Nanoseconds time,
                                                      const Velocity& v) const noexcept {
    State<joints, T> s{time, m.measured.q, m.measured.dq};
    Stiff::put(m.stiff.q.value, s.q);
    Stiff::put(v, s.dq);
    return s;
  }
  [[nodiscard]] JointTorque<joints, T> held(const JointPosition<joints, T>& q,
                                            const DrivenTorque& drag) const noexcept {
    JointTorque<joints, T> out;
    Driven::put(Driven::of(gravity_torque(model_, q)) - drag, out);
    return out;
  }
  [[nodiscard]] DrivenTorque friction(const State<joints, T>& s) const noexcept {
    DrivenTorque drag;
    if (!has_friction_) return drag;
    const auto mass = mass_matrix(model_, s.q);
    const T h = seconds<T>(virtual_.parameters().period);
    for (std::size_t k = 0; k < Driven::count; ++k) {
      const std::size_t i = Driven::index[k];
      drag[k] = detail::held_friction(viscous_[k], mass(i, i), h, s.dq[i]);
    }
    return drag;
  }
  /// The command of both parts.
  SKINCTL_INLINE void compose(Memory& m, const DrivenTorque& torque) const noexcept {
    const auto& c = m.stiff.command;
    m.command = {c.time, c.valid, m.measured.q, m.measured.dq, {}, {}};
    Stiff::put(c.position, m.command.position);
    Stiff::put(c.velocity, m.command.velocity);
    Stiff::put(c.acceleration, m.command.acceleration);
    Stiff::put(c.torque, m.command.torque);
    Driven::put(torque, m.command.torque);
  }

  [[no_unique_address]] M model_;
  detail::VirtualJoints<I, Stiff::count, T, History> virtual_;
  JointLimits<Driven::count, T> limits_;
  DrivenTorque viscous_;
  JointTorque<joints, T> inertia_, torques_;
  [[no_unique_address]] NoToolShape no_tool_;
  bool has_friction_ = false;
};

SKINCTL_END_NAMESPACE

#include "skinctl/resolver/detail/hybrid_loop.hpp"
