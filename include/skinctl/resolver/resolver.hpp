// SPDX-License-Identifier: BSD-3-Clause
// From torque to commands: a virtual robot that carries the fused torque and stays with the real one.
#pragma once

#include <span>

#include "skinctl/resolver/detail/resolver_driven.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Stand-in for a governor's limits of jerk where there are none: joints move within their own limits alone.
struct NoJerkLimits {
  static constexpr bool smooth = false;
  template <std::size_t>
  [[nodiscard]] static constexpr Abrupt motion_limit_of() noexcept {
    return {};
  }
};

/// The result of one cycle of a resolver: the command, its status, the torque of each part of the law in its
/// last evaluation, the torque that holds the joints by torque, friction included, and the torque that brakes
/// and holds them if the guard refuses the command.
template <std::size_t N, Real T, std::size_t Terms>
struct Resolved {
  JointCommand<N, T> command;
  Status status;
  std::array<JointTorque<N, T>, Terms> shares;
  JointTorque<N, T> hold, fallback;

  /// Writes each member once: GCC would first zero the aggregate, by an instruction that starts slowly.
  SKINCTL_INLINE Resolved(const JointCommand<N, T>& given, Status found,
                          const std::array<JointTorque<N, T>, Terms>& parts) noexcept
      : command(given), status(found), shares(parts) {}
};

/// The torque resolver of the paper's section 4.5: one robot, one law, one fused torque, and joints in
/// groups. Stiff joints take positions or velocities, the others, by torque, take torques.
///
/// **Stiff joints.** A virtual robot with the model's M, C, G and the configured friction carries the fused
/// torque: `M dv = tau - (C + B) v - G - tau_c(v)`, `dq^ = v`, sub-stepped over the interval just passed. All
/// laws read its state `(q^, v)`, which is sent. One planner moves it: its state is the last command with its
/// speed and acceleration; laws, stops and the way back from an obstacle are wishes. A joint always comes to
/// rest within an interval:
///
/// - its ends, within its limits of velocity and acceleration, and of jerk (`MaxJerk`), see
///   `JointLimits::move`;
/// - the leash: `E = B0 + A d (tau + d/2) + (d + tau + t_u) |dq|` about the measured position q,
///   less the gap, and ahead the way to stop, `u^2 / 2A`, from the speed u that is both measured and
///   commanded; with d = delay + period, the lag tau, the undeclared lag t_u that is borne, the dead band B0
///   and the acceleration limit A. The second term fades within 5 (d + tau) of a joint that rests although it
///   is pushed. A robot that follows as declared gets as fast as its limits. One that is held fast pulls the
///   command back (`lead_limited`); laws do not count on after 5 (d + tau) (`blocked`).
/// - Who moves away pays: p is the position that the sent commands should have brought, by declared delay and
///   lag of each group. Of a residual r = q - p beyond B0 the gap takes what the robot moved beyond its
///   farthest place. A gap beyond `largest_gap` is displaced: it brakes until `resume`.
/// - A command is carried out in a period: of a late cycle, forces count for all of its time, the motion for
///   a period.
/// - Position interface: q^ is sent. Velocity interface: v is sent; q^ is where the sent velocities bring it,
///   and goes to the leash, and with a slow drift to the measured position, without motion. No gap is booked.
/// - Impedance interface: q^ is sent, and beside it `M ddq + C dq` of the motion that was sent before; r is
///   taken less what contacts deflect, see `Spring`.
/// - Gravity acts on the virtual robot: a law has to compensate it (`GravityControl`, or `Y_r Theta` with G).
/// - Torque beyond the joints' limits accelerates as asked, but less: `JointLimits::along`.
/// - A stop, or no good measurement for `stale_after`: the quickest stop; the law's memory does not change. A
///   group that brakes holds the other stiff groups too.
///
/// **Joints by torque.** `tau = law(state) - B dq`, cut to the limits of torque and power; the law is
/// evaluated at the end of the cycle, at the newest measurement of these joints, for one period from now. Of
/// the configuration they use the limits of torque, period, longest interval, stale age, and of the virtual
/// dynamics the viscous friction, which they show in addition to their own, and, where all are such, the
/// inertia: that of the motors. A torque acts the loop's delay D late, so friction that would stop a motion
/// in less time would shake it: it is `(B^-1 + D M^-1)^-1 dq`. Positions and velocities are not limited here.
/// During a stop, and if the law's torque is not finite, gravity is compensated, and friction brakes with
/// `0.3 M dq / D` at least; then a stop holds: see `held_in_place`. While the state is stale gravity only.
///
/// To the virtual robot (s) the joints by torque (d) are a load that moves as measured:
/// `M_ss dv = tau_s - (C v)_s - G_s - B v - M_sd ddq_d`, with v of all joints, and `ddq_d` the change of the
/// measured velocities since the last cycle: the arm takes the recoil of a finger that starts or stops.
///
/// - A measurement is taken for all joints or for none: one number that is not finite refuses all of it.
/// - `PassivityParts` names parts that watch over energy and contacts: see `Passivity`. One tank pays for
///   both, at the virtual port of the stiff joints and the real one of those by torque, whose recoil is a
///   port of the stiff ones; the passivity observer watches over the stiff joints, whose commands run ahead.
/// - `Tool`: virtual inertia and friction at a tool that no joint by torque moves; see `ToolShape`.
///
/// A command has all kinds: `stiff(command)` and `torque(command)` are the parts for the devices, and
/// cannot be mixed up, as their types differ; `part_of<Set>(command)` is that of one group.
///
/// In the loop nothing throws or allocates; the cost is that of the law and the integrator, times sub-steps.
template <RobotModel M, Real T, class Sets, class Integrator = CrankNicolson,
          std::size_t History = default_history, class PassivityParts = Passivity<>, class Tool = NoToolShape>
class Resolver : public detail::ResolverDriven<M, T, Sets, Integrator, History, PassivityParts, Tool> {
  using Base = detail::ResolverDriven<M, T, Sets, Integrator, History, PassivityParts, Tool>;

 public:
  using Base::each;
  using Base::has_driven;
  using Base::has_tank;
  using Base::has_virtual;
  using Base::joints;
  using Base::one_group;
  using Driven = typename Base::Driven;
  using Stiff = typename Base::Stiff;
  using Memory = typename Base::Memory;
  template <std::size_t K>
  using Part = typename Base::template Part<K>;
  template <class L, class Touch = NoTouch>
  using Knows = typename Base::template Knows<L, Touch>;

  /// Throws `ConfigurationError` for a number out of its range.
  ///
  /// @param groups  each with its configuration, in a tuple: see `by_groups`.
  /// @param passivity  parts that watch over energy and contacts, see `Passivity`.
  /// @param tool    virtual inertia and friction at the tool, see `ToolShape`.
  template <class... Given>
  Resolver(const M& model, const std::tuple<Given...>& groups,
           const PassivityParts& passivity = PassivityParts(), const Tool& tool = Tool())
      : Base(model, those<detail::IsStiffGroup>(groups), those<detail::IsDrivenGroup>(groups), passivity,
             tool) {}

  /// A resolver of a robot whose joints are one group.
  Resolver(const M& model, const RobotConfiguration<joints, T>& configuration,
           const PassivityParts& passivity = PassivityParts(), const Tool& tool = Tool())
    requires Base::is_one_group
      : Resolver(model, std::tuple(JointGroup<Base::interface, joints_between(0, joints), T>{configuration}),
                 passivity, tool) {}

  using Sent = typename Base::Sent;
  /// The command of the stiff joints, which take positions or velocities.
  [[nodiscard]] static auto stiff(const Sent& command) noexcept {
    typename detail::CommandOf<Stiff::count, T, typename Sets::StiffGroups>::type out;
    detail::take_part<Stiff>(command, out);
    return out;
  }
  /// The commanded torques of the joints by torque [N m].
  [[nodiscard]] static JointTorque<Driven::count, T> torque(const Sent& command) noexcept
    requires has_driven
  {
    return Driven::of(command.torque);
  }

  /// One cycle: integrates `interval` and gives the command for its end.
  ///
  /// @param law, law_memory  the law and its memory, which is advanced.
  /// @param measured         the newest state of the robot, with its stamp; may be old, or faulty.
  /// @param check            whether this robot can be in a state, see `take_measurement`.
  /// @param touches          the skin's mean wrenches on the links, one per sub-step; with a tank best as
  ///                         `TouchWrenches`, otherwise all of it counts as contact.
  /// @param pressed           the contacts for `PassivityObserver`: `PressedAreas`. If
  ///                         they are unknown, one for each link, from the last touch.
  /// @param changes           of the touches from sub-step to sub-step, by which laws get them ahead: see
  ///                         `TouchChange`. Empty: not ahead.
  /// @param movers            limits of jerk of each group, or `Abrupt`: a governor's `motion_limit_of<K>()`.
  template <class L, class Touch, class Check = AnyState, class Pressed = PressedUnknown,
            class Movers = NoJerkLimits>
  SKINCTL_INLINE Resolved<joints, T, terms_of<L>> step(
      Memory& m, const L& law, typename L::Memory& law_memory, const State<joints, T>& measured,
      const Interval& interval, std::span<const Touch> touches, const Check& check = {},
      const Pressed& pressed = {}, std::span<const LawTouch<Touch>> changes = {},
      const Movers& movers = {}) const noexcept {
    Resolved<joints, T, terms_of<L>> out{m.command(), interval.status, {}};
    if (!m.started || interval.substeps == 0) [[unlikely]] {
      m.odd_time = detail::odd_time_of(interval);
      // Even if the clock is wrong, gravity is compensated at the measured position.
      if (m.started) out.fallback = this->held(m, detail::believed(measured, m.measured(), check));
      return out;
    }
    SKINCTL_EXPECTS(touches.size() >= interval.substeps, "one touch per sub-step");
    m.odd_time = detail::no_time;
    const Touch& newest = touches[interval.substeps - 1];
    const T dt = seconds<T>(interval.to - interval.from);
    const auto begun = this->begin(m, measured, interval, check, dt, this->pushed(m, newest));
    out.status |= begun.status | this->watch(m, pressed, newest, dt);
    [[maybe_unused]] auto load = this->load_of(m, begun, newest, dt);
    this->resume_law(m, law, law_memory, newest, begun.stale);

    Torque torque;
    if constexpr (has_virtual) torque = this->stiff_only(m.command().torque);
    if constexpr (has_virtual)
      for (unsigned j = 0; j < interval.substeps; ++j)
        move(m, law, law_memory, begun, interval.at(j), seconds<T>(interval.at(j + 1) - interval.at(j)),
             touches[j], changes.empty() ? nullptr : &changes[j], movers, torque, out);
    m.time = interval.to;
    const Nanoseconds left =
        interval.to - interval.from + interval.carried - interval.command_duration(this->period_);
    m.carried = left < this->period_ ? left : this->period_;
    out.status |= detail::note_length(m.short_intervals, interval, this->period_);
    each([&](auto k) {
      auto& group = m.template group<k.value>();
      group.time = m.time;
      if constexpr (!takes_position(Base::template Group<k.value>::interface))
        std::get<k.value>(this->virtual_).at_sent(group);
    });

    const bool braking = m.stop || begun.stale;
    if constexpr (has_driven) {
      Driven::put(Driven::of(load.gravity) - load.resists, out.hold);
      Driven::put(Driven::of(load.gravity) - load.brakes, out.fallback);
      load.given = Driven::of(out.fallback);
      if (!has_virtual && m.stop && !begun.stale) out.status |= Reason::stopping;
    }
    if constexpr (has_driven)
      if (!braking)
        this->ask(m, law, law_memory, this->state(m, m.time, this->velocity(m)),
                  this->ahead_of_driven(newest, changes, dt), dt, load, out);
    if constexpr (has_driven) this->give(m, load, torque, out);
    this->feed_forward(m, torque);
    each([&](auto k) {
      out.status |=
          std::get<k.value>(virtual_).end(m.template group<k.value>(), std::get<k.value>(begun.groups),
                                          Part<k.value>::of(torque), Movers::smooth);
    });
    this->compose(m, torque);
    out.command = m.command();
    return out;
  }

  /// The joint torque by which two configurations of one scene differ: for the stiff joints that which
  /// accelerates the virtual robot under `next` in the coming sub-step as under `before`, less that of
  /// `next`; for those by torque the torque of `before` less that of `next` at the measured state, friction
  /// included. Zero where no law acts. Evaluates both laws, and the integrator for each stiff joint, without
  /// limits.
  template <class L, class Touch, class Check>
  [[nodiscard]] SKINCTL_COLD JointTorque<joints, T> lacking(
      const Memory& m, const State<joints, T>& measured, const Interval& interval, const Check& check,
      const detail::Asked<Resolver, L, Touch>& before,
      const detail::Asked<Resolver, L, Touch>& next) const noexcept {
    Torque lacks;
    if (!m.started || m.stop) return lacks;
    if constexpr (has_virtual)
      if (this->following(m)) Stiff::put(this->lacking_of_stiff(m, interval, before, next), lacks);
    if constexpr (has_driven) {
      State<joints, T> newest = m.measured();
      static_cast<void>(take_measurement(newest, measured, interval.to, check));
      State<joints, T> seen = this->state(m);
      seen.time = has_virtual ? seen.time : newest.time;
      Driven::put(Driven::of(newest.q), seen.q);
      Driven::put(Driven::of(newest.dq), seen.dq);
      const auto sent_by = [&](const auto& who) {
        const Knows<L, Touch> known =
            who.robot.template known<L>(seen, seconds<T>(this->period()), who.touch);
        DrivenTorque sends =
            Driven::of(torque_of(who.law, who.memory, known)) - who.robot.resistance(newest).friction;
        if constexpr (base_moves<M>) sends += Driven::of(who.robot.torque_of_base(m, newest));
        return sends;
      };
      Driven::put(sent_by(before) - sent_by(next), lacks);
    }
    return lacks;
  }

 private:
  using Base::limits_;
  using Base::model_;
  using Base::passivity_;
  using Base::stale_after_;
  using Base::virtual_;
  using Velocity = typename Base::Velocity;
  using Acceleration = typename Base::Acceleration;
  using Torque = typename Base::Torque;
  using DrivenTorque = typename Base::DrivenTorque;

  template <template <class> class Kind, class... Given>
  [[nodiscard]] static auto those(const std::tuple<Given...>& groups) {
    return std::apply([](const auto&... g) { return detail::those_of<Kind>(g...); }, groups);
  }

  /// Moves the stiff joints for `h` seconds, from `at` on.
  template <class L, class Began, class Touch, class Movers, class Out>
  SKINCTL_INLINE void move(Memory& m, const L& law, typename L::Memory& law_memory, const Began& begun,
                           Nanoseconds at, const T& h, const Touch& touch, const LawTouch<Touch>* change,
                           const Movers& movers, Torque& torque, Out& out) const noexcept {
    Velocity v1;
    if (this->following(m)) {
      // Dry friction holds a resting arm against what it feels, and not against the impulse of its change.
      const bool rests = this->has_coulomb_ && this->velocity(m) == Velocity{};
      const auto moved =
          this->drive(m, law, law_memory, this->state(m, at, this->velocity(m)), begun.swing, h,
                      Base::ahead(touch, rests ? nullptr : change, T(this->force_lead_ / h)), touch);
      out.status |= moved.status;
      v1 = moved.velocity;
      if (!this->affords(m, v1)) [[unlikely]]
        out.status |= Reason::energy_held;
      if (!moved.status.has(Reason::torque_not_finite)) [[likely]] {
        torque = moved.torque;
        // A plan waits, and an integral, for a robot that is held.
        if (!begun.held) [[likely]]
          law_memory = moved.law.memory;
        out.shares = moved.law.shares;
      }
    }
    [[maybe_unused]] const auto from = this->position(m);
    this->go(m, begun.groups, h, movers, v1, out.status);
    if constexpr (has_tank)
      passivity_.template get<EnergyTank<T>>().book(m.passivity.template of<EnergyTank<T>>(),
                                                    this->position(m) - from, this->shape_, h);
  }
};

SKINCTL_END_NAMESPACE
