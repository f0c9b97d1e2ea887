// A whole cycle as one pure function: from measurements and samples to a command.
#pragma once

#include <span>
#include <type_traits>

#include "skinctl/core/evaluate.hpp"
#include "skinctl/core/real_time.hpp"
#include "skinctl/cycle/detail/check_arithmetic.hpp"
#include "skinctl/cycle/detail/check_scene.hpp"
#include "skinctl/cycle/detail/dry_step.hpp"
#include "skinctl/cycle/detail/scene_traits.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/cycle/output.hpp"
#include "skinctl/cycle/stage.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/tactile/coverage.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class C, std::size_t Count>
class Configurations;
namespace detail {
template <class Scene, class LawMemory>
struct ChangeFrom;
}

/// A scene: a robot, its skin, its law. `Cycle(arm, skin, law)` derives resolver and guard from the
/// description `arm`; `.with(...)` adds limits of jerk, tool speed and contact, and settings of the guard. A
/// guard or a governor built by hand follows the law in the argument list. All of it is immutable
/// configuration; the state is a `Memory`. A cycle is a function of memory and input alone, so it can be
/// recorded, replayed bit for bit, started at any state and run as fast as the machine can.
///
/// The resolver builds `Quantities` from the union of the needs of law and integrator, at compile time;
/// nothing else of the model is computed.
template <class Resolver, class GivenLaw, class GivenSkin = NoSkin,
          class Watchman = detail::DefaultGuard<Resolver>, class Overseer = detail::DefaultGovernor<Resolver>>
class Cycle {
  using Scene = detail::Scene<Resolver, GivenLaw, GivenSkin>;
  static_assert(sizeof(detail::SaySkin<Scene::skin_fault, GivenSkin>) > 0);
  static_assert(sizeof(detail::Say<Scene::law_fault, typename Scene::Finding::Law>) > 0);
  using Skin = typename Scene::Skin;
  using L = typename Scene::Law;

 public:
  static constexpr bool governed = !std::is_same_v<Overseer, NoGovernor>;
  static constexpr detail::GuardFault guard_fault = detail::fault_in_guard<Watchman, Resolver>();
  static_assert(guard_fault != detail::GuardFault::interface,
                "this guard is for another interface than the robot's: leave it out, a cycle builds its own");
  static_assert(guard_fault != detail::GuardFault::joints,
                "this guard is for a robot with another number of joints: leave it out");
  static_assert(guard_fault != detail::GuardFault::scalar,
                "this guard is for a robot in another scalar: leave it out");
  static_assert(!detail::limits_jerk<Overseer> || detail::commands_motion<Resolver>,
                "a torque interface has no motion whose jerk could be limited: leave JerkLimits out");
  static_assert(detail::governs<Overseer, Resolver::joints, typename Resolver::scalar>,
                "the governor is of a robot with other joints, or of another scalar");
  static_assert(detail::feels<Overseer, GivenSkin>,
                "contact limits need a skin on each link that they name: what is not felt cannot be limited");
  static_assert(!detail::watches_skin<Overseer> ||
                    (detail::CountsCells<Skin> && !std::is_same_v<Skin, NoSkin>),
                "SkinWatch: this scene has no skin whose cells could fall silent");
  static constexpr std::size_t joints = Resolver::joints;
  using scalar = typename Resolver::scalar;
  using law_type = L;
  using Goal = typename detail::GoalType<L>::type;
  using Sensed = typename detail::SensedBy<Skin>::type;
  static constexpr bool has_gripper = detail::has_gripper<L>;
  /// Whether it stays clear of what its input says is around: see `ClearanceAround`.
  static constexpr bool has_surroundings = requires { requires Overseer::has_surroundings; };
  using Input =
      CycleInput<joints, scalar, Goal, Sensed, std::conditional_t<has_gripper, GripperState, NoGripper>,
                 typename detail::AroundOf<Overseer>::type>;
  using Output =
      CycleOutput<joints, scalar, terms_of<L>, std::conditional_t<has_gripper, GripperCommand, NoGripper>>;
  using Wrenches = typename Skin::Wrenches;
  using Known = typename Resolver::template Knows<L, Wrenches>;
  static constexpr bool watches_contacts =
      detail::watches_contacts<Resolver> || requires { Overseer::contact_type::links; };
  /// What the resolver takes: forces and proximities apart where they have to be told.
  using Touch = typename detail::TouchFor<Resolver, Skin, watches_contacts>::type;

  /// The state that changes from cycle to cycle; trivially copyable.
  struct Memory {
    typename Resolver::Memory robot;
    typename L::Memory law;
    typename Watchman::Memory guard;
    typename Skin::Memory skin;
    [[no_unique_address]] typename Overseer::Memory governor;
  };

  /// @param robot  a description (`by_position(...)`), or a resolver built by hand.
  /// Throws `ConfigurationError` where settings of law or guard differ from the robot's description.
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law)
      : Cycle(Whole{}, robot, std::move(skin), law, detail::default_guard<Resolver>,
              detail::default_governor<Resolver>) {}
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Watchman& guard)
      : Cycle(Whole{}, robot, std::move(skin), law, given(guard), detail::default_governor<Resolver>) {}
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Overseer& governor)
      : Cycle(Whole{}, robot, std::move(skin), law, detail::default_guard<Resolver>, given(governor)) {}
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Watchman& guard, const Overseer& governor)
      : Cycle(Whole{}, robot, std::move(skin), law, given(guard), given(governor)) {}
  /// Without skin.
  template <class Robot>
    requires std::is_same_v<Skin, NoSkin>
  Cycle(const Robot& robot, const L& law)
      : Cycle(Whole{}, robot, NoSkin{}, law, detail::default_guard<Resolver>,
              detail::default_governor<Resolver>) {}
  template <class Robot, class... ByHand>
    requires(std::is_same_v<Skin, NoSkin> && sizeof...(ByHand) > 0)
  Cycle(const Robot& robot, const L& law, const ByHand&... guard_and_governor)
      : Cycle(robot, NoSkin{}, law, guard_and_governor...) {}

  /// The same scene with more limits of the whole robot (`MaxJerk`, `MaxToolSpeed<link>`, `LinkContact<link>`,
  /// `Clearance`, `ClearanceAround`, `SkinWatch`) or with settings of its guard (`GuardSettings`). The order and the
  /// number of calls make no difference: `.with(a).with(b)` is `.with(a, b)`. A scene has one part of each kind, of
  /// `LinkContact` one for each link. Throws `ConfigurationError` for a number out of its range.
  template <class... Parts>
  [[nodiscard]] auto with(const Parts&... parts) const {
    const auto all = std::tuple_cat(detail::parts_in(guard_), detail::parts_in(governor_),
                                    detail::single(detail::made_for(resolver_, parts))...);
    constexpr bool once = detail::each_kind_once<std::remove_cv_t<decltype(all)>>;
    static_assert(once, "with: the scene has a part of this kind already, and takes one of each kind");
    if constexpr (once) {
      const auto governor = detail::governor_of(resolver_, all);
      const auto guard = detail::guard_of(resolver_, all, governor);
      return Cycle<Resolver, L, Skin, std::remove_cv_t<decltype(guard)>,
                   std::remove_cv_t<decltype(governor)>>(resolver_, skin_, law_, guard, governor);
    } else {
      return *this;
    }
  }

  [[nodiscard]] const Resolver& resolver() const noexcept { return resolver_; }
  [[nodiscard]] const L& law() const noexcept { return law_; }
  [[nodiscard]] const Skin& skin() const noexcept { return skin_; }
  [[nodiscard]] const Watchman& guard() const noexcept { return guard_; }
  [[nodiscard]] const Overseer& governor() const noexcept { return governor_; }

  /// The memory with which the scene takes over a robot that reports `measured`: the robot stays there. It is not
  /// believed: the first good state in the input of a cycle decides. A robot that stands elsewhere than `measured` says
  /// (see `Guard`), a state that is not finite, and one that this robot cannot have give a memory whose cycles command
  /// nothing: `command.valid` is false, and the status says `start_refused`. The way on is another start, or
  /// `CycleRequest::resume`, which starts at the measured state of its cycle. Goals from before are gone; one in the
  /// same input counts.
  [[nodiscard]] Memory start(const State<joints, scalar>& measured) const noexcept {
    Memory m{};
    start(m, measured);
    return m;
  }
  /// The same in place, for memories too large for the stack.
  SKINCTL_COLD void start(Memory& m, const State<joints, scalar>& measured) const noexcept {
    m.robot = resolver_.start(measured);
    start_rest(m, measured);
  }
  /// Takes over a robot by position that was told to be at `told`, as its controller reports it (the target of a
  /// UR), and that stands beside it by no more than `RobotConfiguration::largest_gap`: it does not step, and the gap needs no consent.
  [[nodiscard]] Memory start(const State<joints, scalar>& measured,
                             const JointPosition<joints, scalar>& told) const noexcept
    requires detail::takes_positions<Resolver>
  {
    Memory m{};
    start(m, measured, told);
    return m;
  }
  SKINCTL_COLD void start(Memory& m, const State<joints, scalar>& measured,
                          const JointPosition<joints, scalar>& told) const noexcept
    requires detail::takes_positions<Resolver>
  {
    m.robot = resolver_.start(measured, told);
    start_rest(m, m.robot.started ? m.robot.measured() : measured);
  }

  /// What the robot's exposed capsules may fill from now on until it stands, if it brakes now: for others that keep
  /// clear of it. It is at `X_WB` in the world.
  [[nodiscard]] Surroundings<most_exposed_capsules, World, scalar> occupied(
      const Memory& m, const Transform<World, Base, scalar>& X_WB) const noexcept
    requires has_surroundings
  {
    Surroundings<most_exposed_capsules, World, scalar> out;
    auto is = m.robot.measured();
    is.q += resolver_.gap(m.robot);  // where it really is
    const auto filled = [&] {
      if constexpr (detail::has_one_interface<Resolver>) {
        return governor_.clearance().occupied(m.guard.command, is);
      } else {
        return governor_.clearance().occupied(guard_.last(m.guard), is);
      }
    }();
    out.time = filled.time;
    out.add(X_WB, filled);
    return out;
  }

  /// One cycle: `(memory, input) -> (output, memory')`, the interval being the time since the last one.
  [[nodiscard]] std::pair<Output, Memory> operator()(const Memory& memory,
                                                     const Input& input) const noexcept {
    std::pair<Output, Memory> result{Output{}, memory};
    result.first = step(result.second, input);
    return result;
  }

  /// The same in place, for the loop. No allocation, lock, exception or system call.
  template <class Watch = NoStopwatch>
  SKINCTL_NOINLINE Output step(Memory& m, const Input& input, Watch&& watch = {}) const noexcept {
    return run(m, input, watch, detail::NoChange{});
  }
  /// Brings the code and the data of the next step into the processor's caches, from which other programs push them
  /// while a loop waits for a state: makes a step on a copy of `memory` in `scratch`, as if the next state came `after`
  /// later than `input`, and throws its output away. Only `scratch` changes. A step with another type of stopwatch is
  /// other code, and stays cold.
  ///
  /// Call it shortly before a state is due; `run_loop` does (`LoopOptions::warm`).
  template <class Watch = NoStopwatch>
  void warm(Memory& scratch, const Memory& memory, const Input& input, Nanoseconds after,
            Watch&& watch = {}) const noexcept {
    detail::dry_step(*this, scratch, memory, input, after, watch);
  }

 private:
  /// All but the robot.
  SKINCTL_COLD void start_rest(Memory& m, const State<joints, scalar>& measured) const noexcept {
    m.skin = skin_.start(measured.time);
    m.guard = guard_.start(m.robot.command(), measured);
    m.governor = {};
    if constexpr (detail::StartsBlank<L>) {
      m.law = {};
    } else {
      const auto state = resolver_.state(m.robot);
      const Wrenches touch = skin_.wrenches(m.skin);
      m.law = law_.start(resolver_.template known<L>(state, period(), touch));
    }
  }

  template <class, std::size_t>
  friend class Configurations;
  template <class, class>
  friend struct detail::ChangeFrom;

  /// @param change  the configuration of the last cycle, or `NoChange`.
  template <class Watch, class Change>
  SKINCTL_INLINE Output run(Memory& m, const Input& input, Watch& watch, const Change& change) const noexcept;
  SKINCTL_COLD void start_anew(Memory& m, const Input& input) const noexcept;
  template <class Resolved, class Pressed>
  SKINCTL_INLINE auto govern(Memory& m, const Resolved& resolved, const Pressed& pressed,
                             const Interval& interval, bool hard, bool stops) const noexcept;
  SKINCTL_COLD Status receive(Memory& m, const Input& input) const noexcept;
  /// Whether the watch over the skin holds a robot that nobody else has stopped.
  [[nodiscard]] SKINCTL_INLINE bool pauses(const Memory& m) const noexcept {
    if constexpr (detail::watches_skin<Overseer>) {
      return governor_.watch().holds(m.governor.watch) && !resolver_.stops(m.robot);
    } else {
      return false;
    }
  }

  /// Made by every public constructor before anything else of a scene.
  struct Whole {
    Whole() { detail::check_arithmetic<scalar>(); }
  };
  template <class V>
  [[nodiscard]] static auto given(const V& value) {
    return [&value](const Resolver&) -> const V& { return value; };
  }
  template <class Robot, class MakeGuard, class MakeGovernor>
  Cycle(Whole, const Robot& robot, Skin&& skin, const L& law, const MakeGuard& guard,
        const MakeGovernor& governor)
      : resolver_(detail::as_resolver(robot)),
        law_(law),
        guard_(guard(resolver_)),
        skin_(std::move(skin)),
        governor_(governor(resolver_)) {
    if constexpr (detail::Described<Robot>) {
      detail::check_holders<Robot, L>();
      detail::check_settings(robot, law);
      detail::check_contacts(robot, skin_);
    }
    if constexpr (requires { law.waits_for_contacts(); } && !requires { typename Skin::Found; })
      require(!law.waits_for_contacts(), "skills that wait for contacts, on a skin that finds none", 1,
              "a ContactSkin");
    if constexpr (detail::limits_jerk<Overseer>) detail::check_no_lead(resolver_);
    detail::compare(guard_, resolver_);
  }
  /// The planned interval [s], for the laws that start or take goals between two evaluations.
  [[nodiscard]] scalar period() const noexcept { return resolver_.planned_step(); }

  // For `Configurations`: whether another one may take over now; the law's start at the robot's state; the
  // difference of torque between the old configuration and this one.
  [[nodiscard]] bool may_change(const Memory& m, const Input& input) const noexcept;
  SKINCTL_COLD void restart(Memory& m) const noexcept;
  SKINCTL_COLD void carry_from(const Cycle& before, const typename L::Memory& law_before, Memory& m,
                               const State<joints, scalar>& measured,
                               const Interval& interval) const noexcept;

  Resolver resolver_;
  L law_;
  Watchman guard_;
  Skin skin_;
  [[no_unique_address]] Overseer governor_;
};

/// For a skin that was given behind the law: the error names its place.
template <class L, class Skin, class Guard, class Governor>
class Cycle<detail::SkinBehindLaw, L, Skin, Guard, Governor> {
  static_assert(!std::is_same_v<L, L>, "order: robot, skin, law; the skin stands before the law");

 public:
  constexpr Cycle(const auto&...) noexcept {}
};
template <class R, class L, detail::SkinLike S>
  requires(!detail::SkinLike<L>)
Cycle(const R&, const L&, const S&) -> Cycle<detail::SkinBehindLaw, L, S, NoGovernor, NoGovernor>;
template <class R, detail::SkinLike S, class L>
Cycle(const R&, const S&, const L&) -> Cycle<detail::ResolverFor<R>, L, S>;
template <class R, detail::SkinLike S, class L, detail::GuardLike G>
Cycle(const R&, const S&, const L&, const G&) -> Cycle<detail::ResolverFor<R>, L, S, G>;
template <class R, detail::SkinLike S, class L, detail::GovernorLike O>
Cycle(const R&, const S&, const L&, const O&)
    -> Cycle<detail::ResolverFor<R>, L, S, detail::DefaultGuard<detail::ResolverFor<R>>, O>;
template <class R, detail::SkinLike S, class L, class G, class O>
Cycle(const R&, const S&, const L&, const G&, const O&) -> Cycle<detail::ResolverFor<R>, L, S, G, O>;
template <class R, class L>
  requires(!detail::SkinLike<L>)
Cycle(const R&, const L&) -> Cycle<detail::ResolverFor<R>, L>;
template <class R, class L, detail::GuardLike G>
  requires(!detail::SkinLike<L>)
Cycle(const R&, const L&, const G&) -> Cycle<detail::ResolverFor<R>, L, NoSkin, G>;
template <class R, class L, detail::GovernorLike O>
  requires(!detail::SkinLike<L>)
Cycle(const R&, const L&, const O&)
    -> Cycle<detail::ResolverFor<R>, L, NoSkin, detail::DefaultGuard<detail::ResolverFor<R>>, O>;
template <class R, class L, class G, detail::GovernorLike O>
  requires(!detail::SkinLike<L>)
Cycle(const R&, const L&, const G&, const O&) -> Cycle<detail::ResolverFor<R>, L, NoSkin, G, O>;

SKINCTL_END_NAMESPACE

#include "skinctl/cycle/detail/cycle_step.hpp"
