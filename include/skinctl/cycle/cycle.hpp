// A whole cycle as one pure function: from what the sensors say to what the robot is told.
#pragma once

#include <span>
#include <type_traits>

#include "skinctl/core/evaluate.hpp"
#include "skinctl/core/real_time.hpp"
#include "skinctl/cycle/detail/check_scene.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/cycle/stage.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/governor.hpp"
#include "skinctl/resolver/resolver.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The place of a skin in a scene that has none.
struct Bare {
  using Wrenches = NoTouch;
  struct Memory {
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };
  [[nodiscard]] Memory start(Nanoseconds) const noexcept { return {}; }
  /// Samples of a robot without skin are of unknown cells.
  Status receive(Memory&, std::span<const CellSample> samples, Nanoseconds, Nanoseconds, std::size_t,
                 Wrenches*) const noexcept {
    return samples.empty() ? Status{} : Status{Reason::sample_unknown};
  }
  [[nodiscard]] Wrenches wrenches(const Memory&) const noexcept { return {}; }
};

/// What one cycle gives.
template <std::size_t N, Scalar T, std::size_t Terms>
struct Output {
  JointCommand<N, T> command;                   ///< what may be sent, if it is valid
  Status status;                                ///< what was limited, held or refused
  std::array<JointTorque<N, T>, Terms> shares;  ///< what each law contributed in the last sub-step [N m]
};

namespace detail {
/// `N` values of a type without resources, of which only those are touched that somebody writes.
template <class V, std::size_t N>
union Unwritten {
  static_assert(std::is_trivially_copyable_v<V>);
  V data[N];
  Unwritten() noexcept {}
};
template <class Overseer>
inline constexpr bool is_governor = false;
template <std::size_t N, Real T, class... Parts>
inline constexpr bool is_governor<Governor<N, T, Parts...>> = true;
template <class Overseer>
inline constexpr bool limits_jerk = requires { requires Overseer::has_jerk; };
/// Whether a governor suits a robot's joints and scalar.
template <class Overseer, std::size_t N, class T>
inline constexpr bool governs = true;
template <std::size_t M, Real U, class J, class S, class C, std::size_t N, class T>
inline constexpr bool governs<Governor<M, U, J, S, C>, N, T> = M == N && std::is_same_v<U, T>;
/// Whether a skin feels all that a governor's contact limits name.
template <class Overseer, class Skin>
inline constexpr bool feels = true;
template <std::size_t N, Real T, class J, class S, class C, class Skin>
  requires requires { C::links; }
inline constexpr bool feels<Governor<N, T, J, S, C>, Skin> = [] {
  if constexpr (requires { Skin::Wrenches::links; }) {
    return (Skin::Wrenches::links & C::links) == C::links;
  } else {
    return false;
  }
}();
/// The strongest proximity reading for each link of a governor's contact limits.
template <class Overseer, class Skin>
[[nodiscard]] SKINCTL_INLINE auto nearest(const Skin& skin, const typename Skin::Memory& memory) noexcept {
  if constexpr (requires { Overseer::contact_type::links; }) {
    return Overseer::contact_type::nearest(skin, memory);
  } else {
    return NoTouch{};
  }
}
/// Whether all joints of a resolver take the same, and whether that is a motion.
template <class Resolver>
inline constexpr bool has_one_interface = requires { Resolver::interface; };
template <class Resolver>
inline constexpr bool commands_motion = requires { requires Resolver::interface != Interface::torque; };
/// The guard of a resolver whose joints are all of one kind.
template <class Resolver>
struct GuardOf {};
template <class Resolver>
  requires requires { Resolver::interface; }
struct GuardOf<Resolver> {
  using type = Guard<Resolver::interface, Resolver::joints, typename Resolver::scalar>;
};
template <class L>
struct GoalType {
  using type = NoGoal;
};
template <class L>
  requires requires { typename L::Goal; }
struct GoalType<L> {
  using type = typename L::Goal;
};
}  // namespace detail

/// A scene: which robot and interface (the resolver), which law, which skin, which guard, and for limits of
/// jerk, tool speed and contact a governor (`make_governor`). All of it is configuration; what changes is a
/// `Memory`. A cycle is a function of memory and input alone, so it can be recorded, replayed bit for bit,
/// started at any state and run as fast as the machine can.
///
/// The resolver builds `Quantities` from the union of what law and integrator need, at compile time; nothing
/// else of the model is computed.
template <class Resolver, class GivenLaw, class GivenSkin = Bare,
          class Watchman = typename detail::GuardOf<Resolver>::type, class Overseer = NoGovernor>
class Cycle {
  using Scene = detail::Scene<Resolver, GivenLaw, GivenSkin>;
  static_assert(sizeof(detail::SaySkin<Scene::skin_fault, GivenSkin>) > 0);
  static_assert(sizeof(detail::Say<Scene::law_fault, typename Scene::Finding::Law>) > 0);
  using Skin = typename Scene::Skin;
  using L = typename Scene::Law;

 public:
  static constexpr bool governed = !std::is_same_v<Overseer, NoGovernor>;
  static_assert(!governed || detail::has_one_interface<Resolver>,
                "a governor is for a robot whose joints all take the same: leave it out");
  static_assert(!detail::limits_jerk<Overseer> || detail::commands_motion<Resolver>,
                "a torque interface has no motion whose jerk could be limited: leave JerkLimits out");
  static_assert(detail::governs<Overseer, Resolver::joints, typename Resolver::scalar>,
                "the governor is of a robot with other joints, or of another scalar");
  static_assert(detail::feels<Overseer, GivenSkin>,
                "contact limits need a skin on each link that they name: what is not felt cannot be limited");
  static constexpr std::size_t joints = Resolver::joints;
  using scalar = typename Resolver::scalar;
  using law_type = L;
  using Goal = typename detail::GoalType<L>::type;
  using Input = skinctl::Input<joints, scalar, Goal>;
  using Output = skinctl::Output<joints, scalar, terms_of<L>>;
  using Wrenches = typename Skin::Wrenches;
  using Known = typename Resolver::template Knows<L, Wrenches>;

  /// All that changes from cycle to cycle; trivially copyable.
  struct Memory {
    typename Resolver::Memory robot;
    typename L::Memory law;
    typename Watchman::Memory guard;
    typename Skin::Memory skin;
    [[no_unique_address]] typename Overseer::Memory governor;
  };

  Cycle(const Resolver& resolver, const L& law, const Skin& skin, const Watchman& guard,
        const Overseer& governor = {})
      : resolver_(resolver), law_(law), guard_(guard), skin_(skin), governor_(governor) {}
  Cycle(const Resolver& resolver, const L& law, const Watchman& guard)
    requires std::is_same_v<Skin, Bare>
      : Cycle(resolver, law, Bare{}, guard) {}
  Cycle(const Resolver& resolver, const L& law, const Watchman& guard, const Overseer& governor)
    requires(std::is_same_v<Skin, Bare> && detail::is_governor<Overseer>)
      : Cycle(resolver, law, Bare{}, guard, governor) {}

  [[nodiscard]] const Resolver& resolver() const noexcept { return resolver_; }
  [[nodiscard]] const L& law() const noexcept { return law_; }
  [[nodiscard]] const Skin& skin() const noexcept { return skin_; }
  [[nodiscard]] const Watchman& guard() const noexcept { return guard_; }
  [[nodiscard]] const Overseer& governor() const noexcept { return governor_; }

  /// The memory with which the scene takes over a robot that reports `measured`: it stays where it is. A
  /// state that is not finite gives a memory whose cycles command nothing (`command.valid` is false).
  [[nodiscard]] Memory start(const State<joints, scalar>& measured) const noexcept {
    Memory m{};
    start(m, measured);
    return m;
  }
  /// The same in place, for memories too large for the stack.
  SKINCTL_COLD void start(Memory& m, const State<joints, scalar>& measured) const noexcept {
    m.robot = resolver_.start(measured);
    m.skin = skin_.start(measured.time);
    m.guard = guard_.start(m.robot.command, measured);
    m.governor = {};
    const auto state = resolver_.state(m.robot);
    const Wrenches touch = skin_.wrenches(m.skin);
    m.law = law_.start(Known(resolver_.model(), state, period(), touch));
  }

  /// One cycle: `(memory, input) -> (output, memory')`, the interval being the time since the last one.
  [[nodiscard]] std::pair<Output, Memory> operator()(const Memory& memory,
                                                     const Input& input) const noexcept {
    std::pair<Output, Memory> result{Output{}, memory};
    result.first = step(result.second, input);
    return result;
  }

  /// The same in place: what the loop calls. Nothing is allocated, locked or thrown; no system call.
  template <class Watch = NoStopwatch>
  Output step(Memory& m, const Input& input, Watch&& watch = {}) const noexcept {
    const RealTimeScope real_time;
    watch.begin();
    Output out;
    if (input.request == Request::stop) resolver_.stop(m.robot);
    if (input.request == Request::resume) {
      resolver_.resume(m.robot);
      guard_.acknowledge(m.guard);
    }
    if (input.has_goal) out.status |= receive(m, input);

    const Interval interval = resolver_.interval(m.robot, input.now);
    detail::Unwritten<Wrenches, max_substeps> touches;
    const std::size_t parts = interval.substeps == 0 ? 1 : interval.substeps;
    out.status |= interval.status;
    out.status |= skin_.receive(m.skin, input.samples, interval.from, interval.to, parts, touches.data);
    watch.end(Stage::sense);

    // What the robot cannot have is no news of it; NaN is told from it by the resolver.
    const auto& measured = guard_.believes(input.measured) || !detail::is_plausible(input.measured)
                               ? input.measured
                               : m.robot.measured;
    auto resolved = resolver_.step(m.robot, law_, m.law, measured, interval,
                                   std::span<const Wrenches>(touches.data, parts));
    out.status |= resolved.status;
    out.shares = resolved.shares;
    watch.end(Stage::resolve);

    Status found = input.observed;
    bool slowed = false;
    if constexpr (governed) {
      if (interval.substeps != 0) {
        const auto given = govern(m, resolved, interval);
        out.status |= given.status;
        found |= given.status;
        slowed = given.altered;
        resolved.command = given.command;
        if constexpr (Resolver::interface == Interface::torque) resolved.fallback = given.hold;
      }
    }
    const auto guarded = guard_.pass(m.guard, resolved.command, input.measured, input.now, resolved.fallback,
                                     found | out.status);
    out.status |= guarded.status | input.observed;
    out.command.assign(guarded.command);
    if (guarded.altered || slowed) resolver_.sent(m.robot, guarded.command);
    if constexpr (governed) {
      if (guarded.altered && Resolver::interface != Interface::torque)
        governor_.sent(m.governor, guarded.command);
    }
    if (guard_.waits(m.guard)) resolver_.stop(m.robot);
    watch.end(Stage::guard);
    return out;
  }

 private:
  /// The planned interval [s], for the laws that start or take goals between two evaluations.
  [[nodiscard]] scalar period() const noexcept { return resolver_.planned_step(); }

  template <class Resolved>
  SKINCTL_INLINE auto govern(Memory& m, const Resolved& resolved, const Interval& interval) const noexcept {
    const auto dt = seconds<scalar>(interval.to - interval.from);
    const auto touch = skin_.wrenches(m.skin);
    const auto nearest = detail::nearest<Overseer>(skin_, m.skin);
    if constexpr (Resolver::interface == Interface::torque) {
      // By an old velocity nothing can be braked.
      if (resolved.status.has(Reason::state_stale))
        return GovernedTorque<joints, scalar>{{resolved.command, {}, false}, resolved.fallback};
      return governor_.pass_torque(m.governor, resolved.command, resolved.fallback, guard_.waits(m.guard),
                                   m.robot.measured, touch, nearest, dt);
    } else {
      return governor_.pass(m.governor, m.guard.command, resolved.command, m.robot.measured, touch, nearest,
                            dt);
    }
  }

  SKINCTL_COLD Status receive(Memory& m, const Input& input) const noexcept {
    if constexpr (std::is_same_v<Goal, NoGoal>) {
      return Reason::goal_refused;
    } else {
      const auto state = resolver_.state(m.robot);
      const Wrenches touch = skin_.wrenches(m.skin);
      const auto received =
          follow_or_receive(law_, m.law, Known(resolver_.model(), state, period(), touch), input.goal);
      m.law = received.memory;
      return received.status;
    }
  }

  Resolver resolver_;
  L law_;
  Watchman guard_;
  Skin skin_;
  [[no_unique_address]] Overseer governor_;
};

template <class Resolver, class L, class Skin, class Watchman>
Cycle(const Resolver&, const L&, const Skin&, const Watchman&) -> Cycle<Resolver, L, Skin, Watchman>;
template <class Resolver, class L, class Watchman>
Cycle(const Resolver&, const L&, const Watchman&) -> Cycle<Resolver, L, Bare, Watchman>;
template <class Resolver, class L, class Skin, class Watchman, class Overseer>
Cycle(const Resolver&, const L&, const Skin&, const Watchman&, const Overseer&)
    -> Cycle<Resolver, L, Skin, Watchman, Overseer>;
template <class Resolver, class L, class Watchman, std::size_t N, Real T, class... Parts>
Cycle(const Resolver&, const L&, const Watchman&, const Governor<N, T, Parts...>&)
    -> Cycle<Resolver, L, Bare, Watchman, Governor<N, T, Parts...>>;

SKINCTL_END_NAMESPACE
