// The torque interface: the law reads the measured state, and its torque is the command.
#pragma once

#include "skinctl/math/ldlt.hpp"
#include "skinctl/resolver/detail/held_friction.hpp"
#include "skinctl/resolver/resolver.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Memory of the torque interface. Trivially copyable.
template <std::size_t N, Real T, class Tank, class Damper>
struct TorqueResolverMemory {
  bool started = false;
  bool stop = false;
  Nanoseconds time{};
  Nanoseconds odd = detail::no_time;  ///< the last cycle's time, if the clock had gone back
  State<N, T> measured;               ///< the last good measurement
  JointCommand<N, T> command;         ///< the last one
  detail::OwnTorque<N, T> own;        ///< of the laws in the last cycle
  [[no_unique_address]] Tank tank;
  [[no_unique_address]] Damper damper;
};

/// For robots that take torques: `tau = law(measured state) - B dq`, cut to the limits of torque and power.
///
/// Of the configuration it uses the limits of torque, period, longest interval, stale age, and of the virtual
/// dynamics the viscous friction, which the robot then shows in addition to its own, and the inertia, here that of the
/// motors, which real joints have beside the model's links; other virtual dynamics are refused. A torque is held for a period, so friction that would stop a motion in less time would shake
/// it: the friction applied is `(B^-1 + 3/2 h M^-1)^-1 dq`. There is no virtual robot: positions and velocities
/// are not limited here. While the state is stale, during a stop, and if the law's torque is not finite, the
/// command is `fallback`: gravity compensation with friction; without friction while the state is stale, as
/// the velocity is unknown.
///
/// Of `Passivity` it takes the `EnergyTank`, at the real port: the robot gives no more energy than it
/// received and than the tank held; and the `ContactDamper`, for a force that is answered late: its torque is
/// held for a period too, and bounded likewise.
template <RobotModel M, Real T, class Integrator, std::size_t History, class Keeper>
class Resolver<Interface::torque, M, T, Integrator, History, Keeper, NoToolShape> {
  struct NoTank {};
  struct NoDamper {};

 public:
  static_assert(!Keeper::template has<PassivityObserver<T>>,
                "by torque no command runs ahead of the robot: its Passivity is an EnergyTank or a "
                "ContactDamper, leave PassivityObserver out");
  static constexpr bool has_tank = Keeper::template has<EnergyTank<T>>;
  static constexpr bool has_damper = Keeper::template has<ContactDamper<T>>;
  static constexpr bool watches_contacts = has_damper;
  static constexpr std::size_t joints = M::joints;
  static constexpr Interface interface = Interface::torque;
  using scalar = T;
  using Configuration = RobotConfiguration<joints, T>;
  using Memory = TorqueResolverMemory<
      joints, T, std::conditional_t<has_tank, typename EnergyTank<T>::template Held<joints>, NoTank>,
      std::conditional_t<has_damper, typename ContactDamper<T>::template Memory<joints>, NoDamper>>;
  static constexpr Needs keeper_needs = {.angles = has_tank, .mass = has_tank};
  template <class L, class Touch = NoTouch>
  using Knows = Quantities<M, L::needs | keeper_needs, T, Touch, RealMass<joints, T>>;

  /// Throws `ConfigurationError` for a number out of its range.
  Resolver(const M& model, const Configuration& configuration, const Keeper& keeper = Keeper())
      : model_(model), p_(configuration, false), keeper_(keeper) {
    require(p_.shape.damping == T(0), "virtual damping", static_cast<double>(p_.shape.damping),
            "0 for a robot by torque");
    for (std::size_t i = 0; i < joints; ++i) {
      viscous_ = viscous_ || p_.shape.viscous[i] > T(0);
      require(p_.shape.coulomb[i] == T(0), "Coulomb friction", static_cast<double>(p_.shape.coulomb[i]),
              "0 for a robot by torque");
    }
  }

  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return p_.limits; }
  [[nodiscard]] const Keeper& keeper() const noexcept { return keeper_; }
  [[nodiscard]] const detail::ResolverParameters<joints, T>& parameters() const noexcept { return p_; }

  /// The time for which a torque is held in a punctual cycle [s].
  [[nodiscard]] T planned_step() const noexcept { return seconds<T>(p_.period); }

  /// As for the position interface; a state that is not finite gives a memory that has not been started.
  [[nodiscard]] Memory start(const State<joints, T>& measured) const noexcept {
    Memory m;
    if (!detail::is_plausible(measured) || !detail::is_plausible(measured.time)) return m;
    m.started = true;
    m.time = measured.time;
    m.measured = measured;
    m.command = {m.time, true, measured.q, measured.dq, {}, held(measured)};
    if constexpr (has_tank) m.tank = keeper_.template get<EnergyTank<T>>().template hold<joints>();
    return m;
  }

  /// The state that laws read: the last good measurement.
  [[nodiscard]] State<joints, T> state(const Memory& m) const noexcept { return m.measured; }

  /// As for the position interface; a robot by torque has its model's inertia.
  template <class L, class Touch>
  [[nodiscard]] SKINCTL_INLINE Knows<L, Touch> known(const State<joints, T>& state, const T& dt,
                                                     const Touch& touch) const noexcept {
    return Knows<L, Touch>(model_, state, dt, touch, RealMass<joints, T>(p_.limits, p_.shape.inertia));
  }

  /// The time since the last cycle as one sub-step: a torque is held, not integrated.
  [[nodiscard]] Interval interval(const Memory& m, Nanoseconds now) const noexcept {
    Interval out = detail::interval_since(m.started, m.time, m.odd, now, p_.longest_interval);
    out.substeps = out.to > out.from ? 1 : 0;
    return out;
  }

  /// One cycle, as for the position interface; `touches` holds one entry. The law's memory advances by the
  /// last interval; its torque is for one period from now.
  template <class L, class Touch, class Check = AnyState, class Pressed = PressedUnknown>
  SKINCTL_INLINE Resolved<joints, T, terms_of<L>> step(
      Memory& m, const L& law, typename L::Memory& law_memory, const State<joints, T>& measured,
      const Interval& interval, std::span<const Touch> touches, const Check& check = {},
      [[maybe_unused]] const Pressed& pressed = {}) const noexcept {
    Resolved<joints, T, terms_of<L>> out{m.command, interval.status, {}};
    if (!m.started) return out;
    if (interval.substeps == 0) {
      m.odd = detail::odd_time_of(interval);
      // Even if the clock is wrong, gravity is compensated at the measured position.
      out.fallback = held(detail::believed(measured, m.measured, check));
      return out;
    }
    SKINCTL_EXPECTS(!touches.empty(), "one touch");
    m.time = interval.to;
    m.odd = detail::no_time;
    const JointPosition<joints, T> before = m.measured.q;
    out.status |= take_measurement(m.measured, measured, interval.to, check);
    const bool stale = interval.to - m.measured.time > p_.stale_after;
    JointTorque<joints, T> drag = stale ? JointTorque<joints, T>() : friction(m.measured);
    if constexpr (has_damper) {
      const T dt = seconds<T>(interval.to - interval.from);
      if constexpr (std::is_same_v<Pressed, PressedUnknown>) {
        out.status |= damp(m, contact_part(touches[0]), dt, stale, drag);
      } else {
        out.status |= damp(m, pressed, dt, stale, drag);
      }
    }
    const JointTorque<joints, T> gravity = gravity_torque(model_, m.measured.q);
    JointTorque<joints, T> torque = gravity - drag;
    out.fallback = torque;
    [[maybe_unused]] JointTorque<joints, T> port, passive;
    if constexpr (has_tank) {
      const auto& tank = keeper_.template get<EnergyTank<T>>();
      port = skin_torque(model_, JointAngles<M, T>(model_, m.measured.q), contact_part(touches[0]));
      tank.book(m.tank, m.measured.q - before, port, gravity);
      passive = tank.settings().port_gain * port + gravity - drag;
    }
    if (stale) {
      out.status |= Reason::state_stale;
    } else if (m.stop) {
      out.status |= Reason::stopping;
    } else {
      const auto& touch = total_of(touches[0]);
      const Knows<L, LawTouch<Touch>> known =
          this->template known<L>(m.measured, seconds<T>(p_.period), touch);
      const auto evaluation = evaluate(law, law_memory, known, seconds<T>(interval.to - interval.from));
      out.status |= evaluation.status;
      if (detail::is_finite(evaluation.torque)) [[likely]] {
        law_memory = evaluation.memory;
        out.shares = evaluation.shares;
        torque = evaluation.torque;
        if (m.own.template bound<L>(out.shares, p_.torque_step(seconds<T>(interval.to - interval.from)),
                                    torque)) [[unlikely]]
          out.status |= Reason::torque_limited;
        torque -= drag;
        if constexpr (has_tank) out.status |= pay(m, known, passive, gravity, torque);
      } else {
        out.status |= Reason::torque_not_finite;
      }
    }
    m.command.torque = p_.limits.within(torque, m.measured.dq);
    if (!(m.command.torque == torque)) out.status |= Reason::torque_limited;
    if (!p_.limits.hold(m.measured.q)) out.status |= Reason::outside_limits;
    if constexpr (has_tank)
      keeper_.template get<EnergyTank<T>>().sent(m.tank, m.command.torque, passive, port, gravity);
    m.command.time = m.time;
    m.command.position = m.measured.q;
    m.command.velocity = m.measured.dq;
    out.command = m.command;
    return out;
  }

  /// The torque that holds the robot without a law: `G(q) - B dq`.
  [[nodiscard]] SKINCTL_INLINE JointTorque<joints, T> held(const State<joints, T>& robot) const noexcept {
    return gravity_torque(model_, robot.q) - friction(robot);
  }

  /// The torque of `before` less that of `next` at the measured state, friction included: two configurations
  /// of the same scene.
  template <class L, class Touch, class Check>
  [[nodiscard]] SKINCTL_COLD JointTorque<joints, T> lacking(
      const Memory& m, const State<joints, T>& measured, const Interval& interval, const Check& check,
      const detail::Asked<Resolver, L, Touch>& before,
      const detail::Asked<Resolver, L, Touch>& next) const noexcept {
    if (!m.started) return {};
    State<joints, T> state = m.measured;
    static_cast<void>(take_measurement(state, measured, interval.to, check));
    const auto sent = [&](const auto& who) {
      const Knows<L, Touch> known = who.robot.template known<L>(state, planned_step(), who.touch);
      return torque_of(who.law, who.memory, known) - who.robot.friction(state);
    };
    return sent(before) - sent(next);
  }
  /// Whether the coming cycle evaluates the law: no stop, no stale state.
  template <class Check>
  [[nodiscard]] bool asks_law(const Memory& m, const State<joints, T>& measured, Nanoseconds now,
                              const Check& check) const noexcept {
    State<joints, T> state = m.measured;
    static_cast<void>(take_measurement(state, measured, now, check));
    return m.started && !m.stop && now - state.time <= p_.stale_after;
  }

  /// Tells that the guard let `command` out instead of the last one.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<joints, T>& command) const noexcept {
    if (!m.started || !command.valid) return;
    m.command.torque = command.torque;
    if constexpr (has_tank) keeper_.template get<EnergyTank<T>>().sent(m.tank, command.torque);
  }
  /// Tells that another configuration has taken over: a torque that differs is no jump of its laws.
  void changed(Memory& m) const noexcept { m.own.known = false; }
  void stop(Memory& m) const noexcept { m.stop = true; }
  [[nodiscard]] static bool stops(const Memory& m) noexcept { return m.stop; }
  /// Ends a stop that was not the user's.
  static void go_on(Memory& m) noexcept { m.stop = false; }
  void resume(Memory& m) const noexcept { m.stop = false; }

 private:
  /// Adds the torque against contacts that ring to `drag`.
  template <class Pressed>
  [[nodiscard]] Status damp(Memory& m, const Pressed& pressed, const T& dt, bool stale,
                            JointTorque<joints, T>& drag) const noexcept {
    const bool rings = keeper_.template get<ContactDamper<T>>().observe(
        m.damper, contacts_of(model_, m.measured.q, pressed), m.measured.dq, dt);
    if (m.damper.damping.any && !stale)
      drag += detail::held_damping<AllJoints<joints>>(m.damper.damping, real_mass(m.measured.q),
                                                      m.measured.dq, seconds<T>(p_.period));
    return rings ? Status(Reason::contact_damped) : Status();
  }
  /// Scales the active part of `torque` down to the share that the tank pays for.
  template <class K>
  SKINCTL_INLINE Status pay(Memory& m, const K& known, const JointTorque<joints, T>& passive,
                            const JointTorque<joints, T>& gravity,
                            JointTorque<joints, T>& torque) const noexcept {
    const JointTorque<joints, T> active = p_.limits.within(torque, m.measured.dq) - passive;
    const JointTorque<joints, T> bias = gravity + coriolis_torque(model_, known.angles(), m.measured.dq);
    const math::Ldlt<joints, T> mass(known.mass().data);
    const T h = known.dt();
    const T share = keeper_.template get<EnergyTank<T>>().pay(m.tank, passive, active, m.measured.dq, h,
                                                              [&](const JointTorque<joints, T>& tau) {
                                                                const JointTorque<joints, T> net = tau - bias;
                                                                JointAcceleration<joints, T> given;
                                                                if (mass.positive_definite())
                                                                  mass.solve(net.data, given.data);
                                                                return integrate(m.measured.dq, given, h);
                                                              });
    if (!(share < T(1))) return {};
    torque = passive + share * active;
    return Reason::tank_empty;
  }
  SKINCTL_INLINE JointTorque<joints, T> friction(const State<joints, T>& robot) const noexcept {
    if (!viscous_) return {};
    return detail::held_friction<AllJoints<joints>>(p_.shape.viscous, real_mass(robot.q), robot.dq,
                                                    seconds<T>(p_.period));
  }
  /// Of links and motors.
  SKINCTL_INLINE MassMatrix<joints, T> real_mass(const JointPosition<joints, T>& q) const noexcept {
    MassMatrix<joints, T> m = mass_matrix(model_, q);
    for (std::size_t i = 0; i < joints; ++i) m(i, i) = m(i, i) + p_.shape.inertia[i];
    return m;
  }

  [[no_unique_address]] M model_;
  detail::ResolverParameters<joints, T> p_;
  bool viscous_ = false;
  [[no_unique_address]] Keeper keeper_;
};

SKINCTL_END_NAMESPACE
