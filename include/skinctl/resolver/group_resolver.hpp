// One robot, one law, and joints of several interfaces: the resolver of groups of joints.
#pragma once

#include "skinctl/resolver/detail/affordable.hpp"
#include "skinctl/resolver/detail/group_memory.hpp"
#include "skinctl/resolver/detail/held_friction.hpp"
#include "skinctl/resolver/resolver_of.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One robot, one law, one fused torque, and joints in groups: stiff joints take positions or velocities,
/// driven joints take torques.
///
/// - A law reads one state: the virtual one of the stiff joints, the measured one of the driven joints.
/// - The stiff joints are treated as by `Resolver`: one virtual robot that carries the law's torque, sub-stepped
///   over the interval just passed; each group has its own delay, lag and observer. The driven joints are a load
///   that moves as measured: `M_ss dv = tau_s - (C v)_s - G_s - B v - M_sd ddq_d`, with v of all joints, and
///   `ddq_d` the change of the measured velocities since the last cycle. So the arm takes the recoil of a finger
///   that starts or stops; what noise of velocities pushes, it pulls back. The other way the world does it: the
///   real fingers feel the real arm.
/// - The driven joints are treated as by `Resolver<Interface::torque>`: the law's torque at the newest
///   measurement, for one period from now, less the configured friction, cut to the limits. For it the law is
///   evaluated once more, at the end of the cycle.
/// - A measurement is taken for all joints or for none: one number that is not finite refuses all of it.
///   While the state is stale, or during a stop, the stiff joints brake and hold, and gravity of the driven
///   ones is compensated, with friction (stale: without). A stiff group that is blocked, displaced or braking
///   holds the other stiff groups and the law's memory; while it is blocked the driven joints go on.
/// - `Passivity`: one tank pays for both, at the virtual port of the stiff joints and the real one of the driven
///   ones; the driven joints' recoil is a port of the stiff ones. The passivity observer watches over the stiff
///   joints, whose commands run ahead. Contact damping acts on all joints.
/// - `ToolShape`: on a link that no driven joint moves.
///
/// A command has all kinds: `stiff(command)` and `torque(command)` are the parts for the devices, and
/// cannot be mixed up, as their types differ; `part_of<Set>(command)` is that of one group.
template <RobotModel M, Real T, class Sets, class Integrator = CrankNicolson, std::size_t History = 32,
          class Keeper = Passivity<>, class Tool = NoToolShape>
class GroupResolver {
 public:
  static constexpr std::size_t joints = M::joints;
  using Driven = typename Sets::Driven;
  using Stiff = typename Sets::Stiff;
  using Groups = typename Sets::StiffGroups;
  static constexpr std::size_t stiff_groups = std::tuple_size_v<Groups>;
  static constexpr bool has_driven = Driven::count > 0;
  using scalar = T;
  using JointSets = Sets;
  static constexpr bool has_tank = Keeper::template has<EnergyTank<T>>;
  static constexpr bool has_passivity_observer = Keeper::template has<PassivityObserver<T>>;
  static constexpr bool has_damper = Keeper::template has<ContactDamper<T>>;
  static constexpr bool watches_contacts = has_passivity_observer || has_damper;
  static constexpr Needs keeper_needs = {
      .angles = has_tank, .gravity = has_tank, .mass = has_tank, .touch = has_tank};
  using Memory = GroupMemory<M, T, Sets, History, Keeper>;
  template <class L, class Touch = NoTouch>
  using Knows = Quantities<M, L::needs | Integrator::needs | keeper_needs, T, Touch,
                           VirtualMass<joints, T, Tool, Stiff>>;

  /// Throws `ConfigurationError` for a number out of its range.
  template <class... Given>
  GroupResolver(const M& model, const std::tuple<Given...>& groups, const Keeper& keeper = Keeper(),
                const Tool& tool = Tool())
      : GroupResolver(model, those(groups, Is<detail::IsStiffGroup>{}),
                      those(groups, Is<detail::IsDrivenGroup>{}), keeper, tool) {}

  [[nodiscard]] const M& model() const noexcept { return model_; }
  /// The limits of all joints.
  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return limits_; }
  [[nodiscard]] const Keeper& keeper() const noexcept { return keeper_; }
  /// The numbers of the stiff group `K` in the form in which the resolver uses them.
  template <std::size_t K = 0>
  [[nodiscard]] SKINCTL_INLINE const auto& parameters() const noexcept {
    return std::get<K>(virtual_).parameters();
  }
  [[nodiscard]] Nanoseconds period() const noexcept { return parameters().period; }
  /// Virtual inertia and friction of the stiff joints, and the friction added to the driven ones.
  [[nodiscard]] const VirtualDynamics<joints, T>& shape() const noexcept { return shape_; }
  /// Length of a sub-step in a punctual cycle [s].
  [[nodiscard]] T planned_step() const noexcept { return parameters().planned_step(); }

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
  [[nodiscard]] SKINCTL_COLD Memory start(const State<joints, T>& measured) const noexcept;

  /// The state that laws read.
  [[nodiscard]] SKINCTL_INLINE State<joints, T> state(const Memory& m) const noexcept {
    return state(m, m.template group<0>().time, velocity(m));
  }
  /// As `Resolver::known`; the virtual inertia is that of the stiff joints.
  template <class L, class Touch>
  [[nodiscard]] SKINCTL_INLINE Knows<L, Touch> known(const State<joints, T>& state, const T& dt,
                                                     const Touch& touch) const noexcept {
    return Knows<L, Touch>(model_, state, dt, touch, {limits_, shape_.inertia, tool_});
  }
  /// The interval that a cycle at `now` has to integrate; empty if `now` is not later than the last cycle.
  [[nodiscard]] Interval interval(const Memory& m, Nanoseconds now) const noexcept {
    return std::get<0>(virtual_).interval(m.template group<0>(), now);
  }

  /// One cycle, as `Resolver::step`.
  template <class L, class Touch, class Check = AnyState, class Pressed = PressedUnknown>
  Resolved<joints, T, terms_of<L>> step(Memory& m, const L& law, typename L::Memory& law_memory,
                                        const State<joints, T>& measured, const Interval& interval,
                                        std::span<const Touch> touches, const Check& check = {},
                                        const Pressed& pressed = {}) const noexcept;

  /// The torque that holds the driven joints without a law: `G(q) - B dq`; zero for the others.
  [[nodiscard]] JointTorque<joints, T> held(const State<joints, T>& robot) const noexcept {
    return held(robot.q, friction(robot));
  }

  /// As `Resolver::lacking`: for the stiff joints the torque that moves them as under `before`, for the driven
  /// ones the difference of torque, friction included.
  template <class L, class Touch, class Check>
  [[nodiscard]] SKINCTL_COLD JointTorque<joints, T> lacking(
      const Memory& m, const State<joints, T>& measured, const Interval& interval, const Check& check,
      const detail::Asked<GroupResolver, L, Touch>& before,
      const detail::Asked<GroupResolver, L, Touch>& next) const noexcept;
  /// Whether the coming cycle evaluates the law for driven joints: no stop, no stale state.
  template <class Check>
  [[nodiscard]] bool asks_law(const Memory& m, const State<joints, T>& measured, Nanoseconds now,
                              const Check& check) const noexcept {
    if constexpr (!has_driven) return true;
    State<joints, T> state = m.measured;
    static_cast<void>(take_measurement(state, measured, now, check));
    return m.started && !m.stop && now - state.time <= stale_after_;
  }

  /// The guard sent `command` instead of the last one.
  void sent(Memory& m, const JointCommand<joints, T>& command) const noexcept;
  /// Tells that another configuration has taken over: a torque that differs is no jump of its laws.
  void changed(Memory& m) const noexcept {
    m.own.known = false;
    if constexpr (has_driven) m.driven.own.known = false;
  }
  /// As `Resolver::stops_or_corrects`, for any group.
  [[nodiscard]] static SKINCTL_INLINE bool stops_or_corrects(const Memory& m) noexcept {
    bool any = false;
    each([&](auto k) {
      const auto& group = m.template group<k.value>();
      any = any || std::tuple_element_t<k.value, decltype(virtual_)>::stops_or_corrects(group);
    });
    return any;
  }
  /// As `Resolver::off`; zero for the driven joints.
  [[nodiscard]] static SKINCTL_INLINE JointPosition<joints, T> off(const Memory& m) noexcept {
    JointPosition<joints, T> out;
    each([&](auto k) {
      const auto& g = m.template group<k.value>();
      Part<k.value>::put(g.residual + g.gap, out);
    });
    return out;
  }
  /// Begins a stop.
  void stop(Memory& m) const noexcept {
    m.stop = true;
    each([&](auto k) { m.template group<k.value>().stop = true; });
  }
  [[nodiscard]] static bool stops(const Memory& m) noexcept { return m.stop; }
  /// Ends a stop that was not the user's: displaced joints wait on.
  static void go_on(Memory& m) noexcept {
    m.stop = false;
    each([&](auto k) { m.template group<k.value>().stop = false; });
  }
  /// Ends a stop; as `Resolver::resume` for a displaced robot.
  void resume(Memory& m) const noexcept {
    m.stop = false;
    each([&](auto k) { std::get<k.value>(virtual_).resume(m.template group<k.value>()); });
  }
  /// The time in which a command of the stiff group `K` is to be reached [s].
  template <std::size_t K>
  [[nodiscard]] SKINCTL_INLINE T span(const Memory& m, const T& dt) const noexcept {
    return Group<K>::interface == Interface::position ? m.template group<K>().command_span : dt;
  }

  /// The joints of the stiff group `K`.
  template <std::size_t K>
  using Group = std::tuple_element_t<K, Groups>;
  template <std::size_t K>
  using Part = JointSubset<joints, Group<K>::set>;
  /// Calls `f(std::integral_constant<std::size_t, K>)` for each stiff group.
  template <class F>
  static SKINCTL_INLINE void each(F&& f) {
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      (f(std::integral_constant<std::size_t, K>{}), ...);
    }(std::make_index_sequence<stiff_groups>{});
  }

 private:
  using Position = JointPosition<joints, T>;
  using Velocity = JointVelocity<joints, T>;
  using Acceleration = JointAcceleration<joints, T>;
  using Torque = JointTorque<joints, T>;
  using StiffTorque = JointTorque<Stiff::count, T>;
  using DrivenTorque = JointTorque<Driven::count, T>;
  template <template <class> class>
  struct Is {};
  template <class... Given, template <class> class Kind>
  [[nodiscard]] static auto those(const std::tuple<Given...>& groups, Is<Kind>) {
    return std::apply([](const auto&... g) { return detail::those_of<Kind>(g...); }, groups);
  }
  template <class... S, class... D>
  SKINCTL_COLD GroupResolver(const M& model, const std::tuple<S...>& stiff, const std::tuple<D...>& driven,
                             const Keeper& keeper, const Tool& tool);

  /// The law's part and the velocities after a sub-step; elements of driven joints are zero.
  template <class L>
  struct Moved {
    template <class F>
    SKINCTL_INLINE explicit Moved(F&& law_now) : law(law_now()), status(law.status) {}

    Evaluation<joints, T, typename L::Memory, terms_of<L>> law;
    Torque torque;  ///< the law's, cut to the limits
    Velocity velocity;
    Status status;
  };
  template <class L, class Touch>
  SKINCTL_NOINLINE Moved<L> drive(Memory& m, const L& law, const typename L::Memory& law_memory,
                                  const State<joints, T>& now, const Acceleration& pull,
                                  const Acceleration& swing, const T& h, const Touch& touch) const noexcept;
  template <class Pressed>
  SKINCTL_INLINE Status watch(Memory& m, const Pressed& pressed, const T& dt) const noexcept;
  SKINCTL_INLINE bool affords(const Memory& m, Velocity& v) const noexcept;
  /// The torque of the law at the end of a cycle: of all joints, and what the driven ones are sent.
  template <class L, class Touch>
  SKINCTL_NOINLINE Status turn(Memory& m, const L& law, const typename L::Memory& law_memory,
                               const State<joints, T>& now, const Touch& touch, const T& dt, Torque& asked,
                               DrivenTorque& driven) const noexcept;
  SKINCTL_INLINE Status pay(Memory& m, const DrivenTorque& passive, const DrivenTorque& gravity,
                            DrivenTorque& torque) const noexcept;

  /// The velocities of the stiff joints; zero for the others.
  [[nodiscard]] SKINCTL_INLINE Velocity velocity(const Memory& m) const noexcept {
    Velocity v;
    each([&](auto k) { Part<k.value>::put(m.template group<k.value>().v, v); });
    return v;
  }
  [[nodiscard]] SKINCTL_INLINE Position position(const Memory& m) const noexcept {
    Position q = m.measured.q;
    each([&](auto k) { Part<k.value>::put(m.template group<k.value>().q.value, q); });
    return q;
  }
  [[nodiscard]] SKINCTL_INLINE Acceleration last(const Memory& m) const noexcept {
    Acceleration a;
    each([&](auto k) { Part<k.value>::put(m.template group<k.value>().last, a); });
    return a;
  }
  /// The state of the virtual joints, moving at `v`, and of the measured ones.
  [[nodiscard]] SKINCTL_INLINE State<joints, T> state(const Memory& m, Nanoseconds time,
                                                      const Velocity& v) const noexcept {
    State<joints, T> s{time, position(m), m.measured.dq};
    Stiff::put(Stiff::of(v), s.dq);
    return s;
  }
  [[nodiscard]] static SKINCTL_INLINE bool following(const Memory& m) noexcept {
    bool all = true;
    each([&](auto k) { all = all && m.template group<k.value>().mode == ResolverMode::following; });
    return all;
  }
  [[nodiscard]] Torque held(const Position& q, const Torque& drag) const noexcept {
    Torque out;
    if constexpr (has_driven) Driven::put(Driven::of(gravity_torque(model_, q) - drag), out);
    return out;
  }
  /// The friction added to the driven joints; zero for the others.
  [[nodiscard]] Torque friction(const State<joints, T>& s) const noexcept {
    Torque drag;
    if constexpr (has_driven)
      if (has_friction_)
        Driven::put(detail::held_friction<Driven>(shape_.viscous, mass_matrix(model_, s.q), s.dq,
                                                  seconds<T>(period())),
                    drag);
    return drag;
  }
  /// The command of all groups.
  SKINCTL_INLINE void compose(Memory& m, const Torque& torque) const noexcept {
    const auto& c = m.template group<0>().command;
    m.command = {c.time, c.valid, m.measured.q, m.measured.dq, {}, {}};
    each([&](auto k) { put_part<Part<k.value>>(m.template group<k.value>().command, m.command); });
    if constexpr (has_driven) Driven::put(Driven::of(torque), m.command.torque);
  }

  template <class... G>
  [[nodiscard]] static auto virtual_of(const std::tuple<G...>& groups) {
    return std::apply(
        [](const auto&... g) {
          return std::tuple<detail::VirtualJoints<G::interface, G::count, T, History>...>(
              detail::VirtualJoints<G::interface, G::count, T, History>(g.configuration)...);
        },
        groups);
  }
  /// The virtual robot's torque within its limits, along the motion that `tau` asks for.
  [[nodiscard]] SKINCTL_COLD Torque limited(const State<joints, T>& now, const Torque& tau) const noexcept {
    Torque hold;
    Velocity v;
    Stiff::put(Stiff::of(bias_torque(model_, JointAngles<M, T>(model_, now.q), now.dq)), hold);
    Stiff::put(Stiff::of(now.dq), v);
    return limits_.along(tau, hold, v);
  }
  template <class Given>
  [[nodiscard]] static SKINCTL_COLD auto limits_of_all(const Given& groups) -> JointLimits<joints, T>;

  [[no_unique_address]] M model_;
  decltype(virtual_of(std::declval<Groups>())) virtual_;
  JointLimits<joints, T> limits_;
  VirtualDynamics<joints, T> shape_;              ///< of all joints; of the driven ones viscous friction
  VirtualDynamics<Stiff::count, T> stiff_shape_;  ///< of the virtual robot
  Nanoseconds stale_after_{};                     ///< of the driven joints
  T torque_rate_ = T(50), driven_torque_rate_ = T(50);
  bool has_coulomb_ = false, has_friction_ = false;
  [[no_unique_address]] Keeper keeper_;
  [[no_unique_address]] Tool tool_;
};

namespace detail {

template <RobotModel M, Real T, class Groups, class... Parts>
struct GroupResolverOf<GroupsDescription<M, T, Groups, Parts...>> {
  using Robot = GroupsDescription<M, T, Groups, Parts...>;
  using Chosen = ChosenParts<Parts...>;
  using Tool = typename Chosen::Tool;
  static_assert(
      Chosen::template count<RobotHoldsGravity> + Chosen::template count<RobotCompensatesFriction> +
              Chosen::template count<FrictionUncompensated> + Chosen::template count<StiffestContactPart> ==
          0,
      "of a robot in groups laws compensate gravity and friction, and its stiffest contact cannot be "
      "checked yet: leave RobotHoldsGravity, RobotCompensatesFriction, FrictionUncompensated and "
      "StiffestContact out");
  using type = GroupResolver<M, T, typename Robot::Sets, typename Chosen::Integrator,
                             Chosen::History::commands, typename Chosen::Keeper::type, Tool>;
  static type make(const Robot& robot) {
    const auto keeper = Chosen::Keeper::of(robot.parts());
    if constexpr (Chosen::template count<ToolShapePart> == 1) {
      return type(robot.model(), robot.groups(), keeper, std::get<Tool>(robot.parts()));
    } else {
      return type(robot.model(), robot.groups(), keeper);
    }
  }
};

}  // namespace detail

SKINCTL_END_NAMESPACE

#include "skinctl/resolver/detail/group_energy.hpp"
#include "skinctl/resolver/detail/group_loop.hpp"
#include "skinctl/resolver/detail/group_setup.hpp"
