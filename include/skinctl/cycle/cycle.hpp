// SPDX-License-Identifier: BSD-3-Clause
// A whole cycle as one pure function: from measurements and samples to a command.
#pragma once

#include "skinctl/cycle/detail/cycle_loop.hpp"
#include "skinctl/cycle/detail/dry_step.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A scene: a robot, its skin, its law. `Cycle(arm, skin, law)` derives resolver and guard from the
/// description `arm`; `.with(...)` adds parts: limits of jerk, tool speed and contact, settings of the guard.
/// All of it is immutable configuration; the state is a `Memory`. A cycle is a function of memory and input
/// alone, so it can be recorded, replayed bit for bit, started at any state and run as fast as the machine
/// can.
///
/// A memory carries the mark of its scene (limits and times of the robot, gravity in its base, ids and places
/// of its cells; not gains, payload or tool). A scene with another mark commands nothing with it:
/// `memory_refused`, and from then on `start_refused`, as after a refused start. Scenes with the same mark
/// cannot tell their memories apart.
///
/// The resolver builds `Quantities` from the union of the needs of law and integrator, at compile time;
/// nothing else of the model is computed.
///
/// @tparam Parts  the list of its parts, a tuple of settings.
template <class Resolver, class GivenLaw, class GivenSkin = NoSkin,
          class Parts = detail::DefaultParts<Resolver>>
class Cycle : public detail::CycleLoop<Resolver, GivenLaw, GivenSkin, Parts> {
  using Scene = detail::Scene<Resolver, GivenLaw, GivenSkin>;
  static_assert(sizeof(detail::SaySkin<Scene::skin_fault, GivenSkin>) > 0);
  static_assert(sizeof(detail::SayTouch<Scene::touch_fault, GivenSkin>) > 0);

  using Loop = detail::CycleLoop<Resolver, GivenLaw, GivenSkin, Parts>;
  using Loop::guard_;
  using Loop::law_;
  using Loop::parts_;
  using Loop::resolver_;
  using Loop::skin_;
  using L = typename Loop::L;
  using Skin = typename Loop::Skin;
  using Whole = typename Loop::Whole;
  template <class Robot>
  using LawArgument = typename Scene::template Argument<Robot>::type;

 public:
  using Loop::joints;
  using scalar = typename Loop::scalar;
  using Input = typename Loop::Input;
  using Output = typename Loop::Output;
  using Memory = typename Loop::Memory;

  /// @param robot  a description (`by_position(...)`), or a resolver.
  /// Throws `ConfigurationError` where settings of the law differ from the robot's description.
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, LawArgument<Robot> law)
      : Loop(Whole{}, robot, std::move(skin), Scene::taken(law), Parts{}) {
    static_assert(detail::gravity_is_held<Robot, L>,
                  "gravity nowhere: add GravityControl to the law, or RobotHoldsGravity to the description");
    detail::check_holders<Robot, L>();
  }
  /// A scene with the list `parts`, in the order of their limits.
  template <class Robot>
  Cycle(const Robot& robot, Skin skin, const L& law, const Parts& parts)
      : Loop(Whole{}, robot, std::move(skin), law, parts) {
    static_assert(detail::gravity_is_held<Robot, L>,
                  "gravity nowhere: add GravityControl to the law, or RobotHoldsGravity to the description");
    detail::check_holders<Robot, L>();
  }
  /// A scene without skin.
  template <class Robot>
    requires std::is_same_v<Skin, NoSkin>
  Cycle(const Robot& robot, LawArgument<Robot> law)
      : Loop(Whole{}, robot, NoSkin{}, Scene::taken(law), Parts{}) {
    static_assert(detail::gravity_is_held<Robot, L>,
                  "gravity nowhere: add GravityControl to the law, or RobotHoldsGravity to the description");
    detail::check_holders<Robot, L>();
  }

  /// This scene with more limits of the whole robot (`MaxJerk`, `MaxToolSpeed<link>`,
  /// `LinkContact<link>`, `Clearance`, `ClearanceAround`, `SkinWatch`) or with settings of its guard
  /// (`GuardSettings`). The order and the number of calls make no difference: `.with(a).with(b)` is `.with(a,
  /// b)`. A scene has one part of each kind, of `LinkContact` one for each link. Throws `ConfigurationError`
  /// for a number out of its range.
  template <class... Given>
  [[nodiscard]] auto with(const Given&... given) const {
    constexpr auto fault = detail::fault_of_parts<Resolver, Skin, Parts, Given...>();
    using enum detail::PartsFault;
    static_assert(fault != no_part,
                  "with: takes settings of limits (limits/limit.hpp) and of the guard, and this is neither");
    static_assert(fault != moves_torques,
                  "a torque interface has no motion whose jerk could be limited: leave MaxJerk out");
    static_assert(
        fault != twice,
        "with: the scene has a part of this kind already: take it out first, scene.without<Kind>()");
    static_assert(fault != two_movers, "with: two limits decide how joints move: leave one out");
    static_assert(
        fault != not_felt,
        "contact limits need a skin on each link that they name: what is not felt cannot be limited");
    static_assert(fault != no_cells,
                  "this limit asks what cells feel (SkinWatch, FeltPlaces), and the scene has none");
    static_assert(((sizeof(detail::SayLimit<detail::fault_of_part<Resolver, Given>(), Given>) > 0) && ...));
    if constexpr (fault == none && detail::parts_are_whole<Resolver, Given...>) {
      const auto all = detail::in_list_order<Resolver>(std::tuple_cat(parts_, std::tuple(given...)));
      return Cycle<Resolver, L, Skin, std::remove_const_t<decltype(all)>>(resolver_, skin_, law_, all);
    } else {
      return *this;
    }
  }
  /// This scene without its part of a kind, named by its settings (`without<SkinWatch>()`) or by the kind.
  template <class Kind>
  [[nodiscard]] auto without() const {
    const auto left = detail::without_kind<Kind>(parts_);
    static_assert(!std::is_same_v<std::remove_const_t<decltype(left)>, Parts>,
                  "without: the scene has no part of this kind");
    return Cycle<Resolver, L, Skin, std::remove_const_t<decltype(left)>>(resolver_, skin_, law_, left);
  }

  /// The memory with which the scene takes over a robot that reports `measured`: the robot stays there. It is
  /// not believed: the first good state in the input of a cycle decides. A robot that stands elsewhere than
  /// `measured` says (see `Guard`), a state that is not finite, and one that this robot cannot have give a
  /// memory whose cycles command nothing: `command.valid` is false, and the status says `start_refused`. The
  /// way on is another start, or `CycleRequest::resume`, which starts at the measured state of its cycle.
  /// Goals from before are gone; one in the same input counts.
  [[nodiscard]] Memory start(const State<joints, scalar>& measured) const noexcept {
    Memory m{};
    start(m, measured);
    return m;
  }
  /// `start` in place, for memories too large for the stack: `start(m, measured)`,
  /// `start(m, measured, told)`.
  using Loop::start;
  /// Takes over a robot by position that was told to be at `told`, as its controller reports it (the target
  /// of a UR), and that stands beside it by no more than `RobotConfiguration::largest_gap`: it does not step,
  /// and the gap needs no consent.
  [[nodiscard]] Memory start(const State<joints, scalar>& measured,
                             const JointPosition<joints, scalar>& told) const noexcept
    requires detail::takes_positions<Resolver>
  {
    Memory m{};
    start(m, measured, told);
    return m;
  }

  /// One cycle: `(memory, input) -> (output, memory')`, the interval being the time since the last one.
  [[nodiscard]] std::pair<Output, Memory> operator()(const Memory& memory,
                                                     const Input& input) const noexcept {
    std::pair<Output, Memory> result{Output{}, memory};
    result.first = step(result.second, input);
    return result;
  }

  /// One cycle in place, for the loop: `m` becomes the next memory. No allocation, lock, exception or system
  /// call.
  template <class Watch = NoStopwatch>
  SKINCTL_NOINLINE Output step(Memory& m, const Input& input, Watch&& watch = {}) const noexcept {
    return this->run(m, input, watch, detail::NoChange{});
  }
  // clang-format off
  Output step(const Memory&, const Input&) const = delete;  // a step changes its memory: no const one, no temporary
  // clang-format on
  /// Brings the code and the data of the next step into the processor's caches, from which other programs
  /// push them while a loop waits for a state: makes a step on a copy of `memory` in `scratch`, as if the
  /// next state came `after` later than `input`, and throws its output away. Only `scratch` changes. A step
  /// with another type of stopwatch is other code, and stays cold.
  ///
  /// Call it shortly before a state is due; `run_loop` does (`LoopOptions::warm`).
  template <class Watch = NoStopwatch>
  void warm(Memory& scratch, const Memory& memory, const Input& input, Nanoseconds after,
            Watch&& watch = {}) const noexcept {
    detail::dry_step(*this, scratch, memory, input, after, watch);
  }
};

/// Stand-in for a scene whose skin was given behind the law: the error names its place.
template <class L, class Skin, class Parts>
class Cycle<detail::SkinBehindLaw, L, Skin, Parts> {
  static_assert(!std::is_same_v<L, L>, "order: robot, skin, law; the skin stands before the law");

 public:
  constexpr Cycle(const auto&...) noexcept {}
};
/// Stand-in for a scene without skin whose law answers the skin; it is refused, as it would never yield.
template <class L, class Skin, class Parts>
class Cycle<detail::SkinForgotten, L, Skin, Parts> {
 public:
  // clang-format off
  constexpr Cycle(const auto&...) = delete;  // the law answers touch, and the scene has no skin: Cycle(robot, skin, law)
  // clang-format on
};
/// Stand-in for a scene with a model in place of a robot: the only constructor is deleted.
template <class L, class Skin, class Parts>
class Cycle<detail::ModelAsRobot, L, Skin, Parts> {
 public:
  // clang-format off
  constexpr Cycle(const auto&...) = delete;  // a model is no robot yet: by_position(model, {.limits = ..., .period = ...}), by_velocity, by_torque
  // clang-format on
};
template <RobotModel M, class X>
Cycle(const M&, const X&) -> Cycle<detail::ModelAsRobot, X, NoSkin, std::tuple<>>;
template <RobotModel M, detail::SkinLike S, class L>
Cycle(const M&, const S&, const L&) -> Cycle<detail::ModelAsRobot, L, S, std::tuple<>>;
template <class R, class L, detail::SkinLike S>
  requires(!detail::SkinLike<L>)
Cycle(const R&, const L&, const S&) -> Cycle<detail::SkinBehindLaw, L, S, std::tuple<>>;
template <class R, detail::SkinLike S, class L>
  requires(!RobotModel<R>)
Cycle(const R&, const S&, const L&) -> Cycle<detail::ResolverFor<R>, L, S>;
template <class R, class L>
  requires(!detail::SkinLike<L> && !RobotModel<R> && !(detail::Described<R> && detail::lives_on_skin<L>))
Cycle(const R&, const L&) -> Cycle<detail::ResolverFor<R>, L>;
template <class R, class L>
  requires(detail::Described<R> && detail::lives_on_skin<L>)
Cycle(const R&, const L&) -> Cycle<detail::SkinForgotten, L, NoSkin, std::tuple<>>;

SKINCTL_END_NAMESPACE
