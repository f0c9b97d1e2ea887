// From torque to commands: a virtual robot that carries the fused torque and stays with the real one.
#pragma once

#include <span>

#include "skinctl/core/detail/copy_whole.hpp"
#include "skinctl/resolver/detail/resolver_driven.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The result of one cycle of a resolver: the command, its status, the torque of each part of the law in its last
/// evaluation, and the torque that holds the driven joints if the guard refuses the command.
template <std::size_t N, Real T, std::size_t Terms>
struct Resolved {
  JointCommand<N, T> command;
  Status status;
  std::array<JointTorque<N, T>, Terms> shares;
  JointTorque<N, T> fallback;

  /// Member by member: GCC would first zero an aggregate of this size, by an instruction that starts slowly.
  SKINCTL_INLINE Resolved(const JointCommand<N, T>& given, Status found,
                          const std::array<JointTorque<N, T>, Terms>& parts) noexcept
      : command(given.copy()), status(found), shares(parts) {}
};

/// The torque resolver of the paper's section 4.5: one robot, one law, one fused torque, and joints in groups.
/// Stiff joints take positions or velocities, driven joints take torques.
///
/// **Stiff joints.** A virtual robot with the model's M, C, G and the configured friction carries the fused torque:
/// `M dv = tau - (C + B) v - G - tau_c(v) + M L2 rho`, `dq^ = u = v + L1 rho`, sub-stepped over the interval just
/// passed. All laws read its state `(q^, v)`, which is sent. The real robot enters through `r`, the measured
/// position minus the position that the sent commands should have brought, by declared delay and lag of each group,
/// and `rho`, the part of r outside of the dead band: a robot that follows as declared is not disturbed, and feels
/// as configured.
///
/// - Position interface: q^ is sent. Velocity interface: v is sent; `L1 rho` and a slow drift move q^ only.
/// - Impedance interface: q^ is sent, and beside it `M ddq + C dq` of the motion that was sent before; r is taken
///   less what contacts deflect, see `Spring`.
/// - Gravity acts on the virtual robot: a law has to compensate it (`GravityControl`, or `Y_r Theta` with G).
/// - Torque beyond the joints' limits accelerates as asked, but less: `JointLimits::along`.
/// - Limits: see `JointLimits::move`; the correction obeys them too, and so does the max lead,
///   `|q^ - q| <= max_lead v_max T`.
/// - A group that stays beyond the dead band for 5 T is blocked: q^ goes to q, v is zero, the law's memory
///   does not change. It ends when the robot is back with q^ and is no longer pushed in the blocked
///   direction, or went on in it, or after `retry`.
/// - Friction of a servo that gives way shows as a joint that moves with commands which are ahead of it by more than
///   the dead band, or that stays when it is tried again: that joint's dead band grows, up to two thirds of the max
///   lead, and shrinks again with a time constant of a minute.
/// - A robot that stands beside its commands by a gap that they do not explain is displaced: v is braked to
///   zero and the law's memory does not change until `resume`, which takes the gap, up to `largest_gap`, off the
///   measurements.
/// - A gap within the dead band is taken off the measurements without consent, but only until the first command
///   moves, for two seconds at most from the start or from `resume` (position interface): commands that have not
///   moved cannot have met an obstacle.
/// - A stop, or no good measurement for `stale_after`: v is braked to zero, the law's memory does not change.
/// - A group that is blocked, displaced or braking holds the other stiff groups too.
///
/// **Driven joints.** `tau = law(state) - B dq`, cut to the limits of torque and power; the law is evaluated at the
/// end of the cycle, at the newest measurement of these joints, for one period from now. Of the configuration they
/// use the limits of torque, period, longest interval, stale age, and of the virtual dynamics the viscous friction,
/// which they show in addition to their own, and, where all joints are driven, the inertia: that of the motors. A
/// torque is held for a period, so friction that would stop a motion in less time would shake it: the friction
/// applied is `(B^-1 + 3/2 h M^-1)^-1 dq`. Positions and velocities of these joints are not limited here. While the
/// state is stale, during a stop, and if the law's torque is not finite, gravity is compensated, with friction
/// (stale: without, as the velocity is unknown).
///
/// To the virtual robot the driven joints are a load that moves as measured:
/// `M_ss dv = tau_s - (C v)_s - G_s - B v - M_sd ddq_d`, with v of all joints, and `ddq_d` the change of the
/// measured velocities since the last cycle: the arm takes the recoil of a finger that starts or stops.
///
/// - A measurement is taken for all joints or for none: one number that is not finite refuses all of it.
/// - `PassivityParts` names parts that watch over energy and contacts: see `Passivity`. One tank pays for both, at the
///   virtual port of the stiff joints and the real one of the driven ones, whose recoil is a port of the stiff ones;
///   the passivity observer watches over the stiff joints, whose commands run ahead.
/// - `Tool`: virtual inertia and friction at the tool, on a link that no driven joint moves; see `ToolShape`.
///
/// A command has all kinds: `stiff(command)` and `torque(command)` are the parts for the devices, and
/// cannot be mixed up, as their types differ; `part_of<Set>(command)` is that of one group.
///
/// In the loop nothing throws or allocates; the cost is that of the law and the integrator, times sub-steps.
template <RobotModel M, Real T, class Sets, class Integrator = CrankNicolson, std::size_t History = 32,
          class PassivityParts = Passivity<>, class Tool = NoToolShape>
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

  /// Of a robot that is one group of joints.
  Resolver(const M& model, const RobotConfiguration<joints, T>& configuration,
           const PassivityParts& passivity = PassivityParts(), const Tool& tool = Tool())
    requires Base::is_one_group
      : Resolver(model, std::tuple(JointGroup<Base::interface, joints_between(0, joints), T>{configuration}),
                 passivity, tool) {}

  using Sent = typename Base::Sent;
  /// The command of the stiff joints.
  [[nodiscard]] static auto stiff(const Sent& c) noexcept {
    typename detail::CommandOf<Stiff::count, T, typename Sets::StiffGroups>::type out;
    detail::take_part<Stiff>(c, out);
    return out;
  }
  /// The command of the driven joints [N m].
  [[nodiscard]] static JointTorque<Driven::count, T> torque(const Sent& c) noexcept
    requires has_driven
  {
    return Driven::of(c.torque);
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
  template <class L, class Touch, class Check = AnyState, class Pressed = PressedUnknown>
  SKINCTL_INLINE Resolved<joints, T, terms_of<L>> step(
      Memory& m, const L& law, typename L::Memory& law_memory, const State<joints, T>& measured,
      const Interval& interval, std::span<const Touch> touches, const Check& check = {},
      const Pressed& pressed = {}, std::span<const LawTouch<Touch>> changes = {}) const noexcept {
    Resolved<joints, T, terms_of<L>> out{m.command(), interval.status, {}};
    if (!m.started || interval.substeps == 0) [[unlikely]] {
      m.odd = detail::odd_time_of(interval);
      // Even if the clock is wrong, gravity is compensated at the measured position.
      if (m.started) out.fallback = this->held(detail::believed(measured, m.measured(), check));
      return out;
    }
    SKINCTL_EXPECTS(touches.size() >= interval.substeps, "one touch per sub-step");
    m.odd = detail::no_time;
    const Touch& newest = touches[interval.substeps - 1];
    const T dt = seconds<T>(interval.to - interval.from);
    const auto begun = this->begin(m, measured, interval, check, dt, this->pushed(m, newest));
    out.status |= begun.status | this->watch(m, pressed, newest, dt);
    [[maybe_unused]] auto load = this->load_of(m, begun, newest);

    Torque torque;
    if constexpr (has_virtual) torque = this->stiff_only(m.command().torque);
    if constexpr (has_virtual)
      for (unsigned j = 0; j < interval.substeps; ++j)
        move(m, law, law_memory, begun, interval.at(j), seconds<T>(interval.at(j + 1) - interval.at(j)),
             touches[j], changes.empty() ? nullptr : &changes[j], torque, out);
    m.time = interval.to;
    each([&](auto k) { m.template group<k.value>().time = m.time; });

    bool blocked = false, braking = m.stop || begun.stale;
    each([&](auto k) {
      const ResolverMode mode = m.template group<k.value>().mode;
      blocked = blocked || mode == ResolverMode::blocked;
      braking = braking || mode == ResolverMode::braking;
    });
    if constexpr (has_driven) {
      Driven::put(Driven::of(load.gravity) - load.resists, out.fallback);
      load.given = Driven::of(out.fallback);
      if (!has_virtual && m.stop && !begun.stale) out.status |= Reason::stopping;
    }
    if (blocked) [[unlikely]]
      out.status |= Reason::blocked;
    if (!braking && (has_driven || blocked))
      turn(m, law, law_memory, begun, blocked, newest, this->ahead_of_driven(newest, changes, dt), dt, load,
           torque, out);
    if constexpr (has_driven) this->give(m, load, torque, out);
    this->feed_forward(m, torque);
    each([&](auto k) {
      out.status |= std::get<k.value>(virtual_).end(
          m.template group<k.value>(), std::get<k.value>(begun.groups), Part<k.value>::of(torque));
    });
    this->compose(m, torque);
    out.command.assign(m.command());
    return out;
  }

  /// The joint torque by which two configurations of one scene differ: for the stiff joints that which
  /// accelerates the virtual robot under `next` in the coming sub-step as under `before`, less that of `next`; for
  /// the driven ones the torque of `before` less that of `next` at the measured state, friction included. Zero where
  /// no law acts. Evaluates both laws, and the integrator for each stiff joint, without limits.
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
        return Driven::of(torque_of(who.law, who.memory, known)) - who.robot.friction(newest);
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

  /// `h` seconds of the stiff joints, from `at` on.
  template <class L, class Began, class Touch, class Out>
  SKINCTL_INLINE void move(Memory& m, const L& law, typename L::Memory& law_memory, const Began& begun,
                           Nanoseconds at, const T& h, const Touch& touch, const LawTouch<Touch>* change,
                           Torque& torque, Out& out) const noexcept {
    Velocity v1;
    if (this->following(m)) {
      // Dry friction holds a resting arm against what it feels, and not against the impulse of its change.
      const bool rests = this->has_coulomb_ && this->velocity(m) == Velocity{};
      const auto moved =
          this->drive(m, law, law_memory, this->state(m, at, this->velocity(m)), begun.pull, begun.swing, h,
                      Base::ahead(touch, rests ? nullptr : change, T(this->force_lead_ / h)), touch);
      out.status |= moved.status;
      detail::copy_row(moved.velocity, v1);
      if (!this->affords(m, v1)) [[unlikely]]
        out.status |= Reason::energy_held;
      if (!moved.status.has(Reason::torque_not_finite)) [[likely]] {
        detail::copy_row(moved.torque, torque);
        detail::copy_whole(moved.law.memory, law_memory);
        detail::copy_whole(moved.law.shares, out.shares);
      }
    }
    [[maybe_unused]] const auto from = this->position(m);
    each([&](auto k) {
      out.status |= std::get<k.value>(virtual_).move(
          m.template group<k.value>(), std::get<k.value>(begun.groups).correction, Part<k.value>::of(v1), h);
    });
    if constexpr (has_tank)
      passivity_.template get<EnergyTank<T>>().book(m.passivity.template of<EnergyTank<T>>(),
                                                    this->position(m) - from, this->shape_, h);
  }

  /// The law at the end of a cycle: for the driven joints, and for groups that are blocked.
  template <class L, class Began, class Touch, class Load, class Out>
  SKINCTL_NOINLINE void turn(Memory& m, const L& law, typename L::Memory& law_memory, const Began& begun,
                             bool blocked, const Touch& touch, const LawTouch<Touch>& felt,
                             [[maybe_unused]] const T& dt, [[maybe_unused]] Load& load, Torque& torque,
                             Out& out) const noexcept {
    const State<joints, T> now = this->state(m, m.time, blocked ? Velocity{} : this->velocity(m));
    Torque asked;
    if constexpr (!has_driven) {
      const auto moved =
          this->drive(m, law, law_memory, now, {}, {}, seconds<T>(this->period()), felt, touch);
      if (moved.status.has(Reason::torque_not_finite)) return;
      asked = moved.torque;
    } else {
      if (!this->ask(m, law, law_memory, now, felt, dt, load, asked, out)) return;
    }
    if (!blocked) return;
    torque = has_driven ? limits_.within(asked, Velocity{}) : asked;
    const Torque net = torque - gravity_torque(model_, JointAngles<M, T>(model_, now.q));
    each([&](auto k) {
      auto& group = m.template group<k.value>();
      if (group.mode == ResolverMode::blocked)
        std::get<k.value>(virtual_).try_to_leave(group, std::get<k.value>(begun.groups).correction,
                                                 Part<k.value>::of(net));
    });
  }
};

SKINCTL_END_NAMESPACE
