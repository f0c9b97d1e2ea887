// A whole cycle as one pure function: from measurements and samples to a command.
#pragma once

#include "skinctl/cycle/detail/cycle_loop.hpp"
#include "skinctl/cycle/detail/dry_step.hpp"

SKINCTL_BEGIN_NAMESPACE

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
class Cycle : detail::FittingParts<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>,
              public detail::CycleLoop<Resolver, GivenLaw, GivenSkin, Watchman, Overseer> {
  using Loop = detail::CycleLoop<Resolver, GivenLaw, GivenSkin, Watchman, Overseer>;
  using Loop::governor_;
  using Loop::guard_;
  using Loop::law_;
  using Loop::resolver_;
  using Loop::skin_;
  using L = typename Loop::L;
  using Skin = typename Loop::Skin;
  using Whole = typename Loop::Whole;

 public:
  using Loop::has_surroundings;
  using Loop::joints;
  using scalar = typename Loop::scalar;
  using Input = typename Loop::Input;
  using Output = typename Loop::Output;
  using Memory = typename Loop::Memory;

  /// @param robot  a description (`by_position(...)`), or a resolver built by hand.
  /// Throws `ConfigurationError` where settings of law or guard differ from the robot's description.
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law)
      : Loop(Whole{}, robot, std::move(skin), law, detail::default_guard<Resolver>,
             detail::default_governor<Resolver>) {}
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Watchman& guard)
      : Loop(Whole{}, robot, std::move(skin), law, Loop::given(guard), detail::default_governor<Resolver>) {}
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Overseer& governor)
      : Loop(Whole{}, robot, std::move(skin), law, detail::default_guard<Resolver>, Loop::given(governor)) {}
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Watchman& guard, const Overseer& governor)
      : Loop(Whole{}, robot, std::move(skin), law, Loop::given(guard), Loop::given(governor)) {}
  /// Without skin.
  template <class Robot>
    requires std::is_same_v<Skin, NoSkin>
  Cycle(const Robot& robot, const L& law)
      : Loop(Whole{}, robot, NoSkin{}, law, detail::default_guard<Resolver>,
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
  /// The same in place, for memories too large for the stack: `start(m, measured)`, `start(m, measured, told)`.
  using Loop::start;
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
    return this->run(m, input, watch, detail::NoChange{});
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
