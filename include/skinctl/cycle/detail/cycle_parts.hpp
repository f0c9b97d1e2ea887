// The parts of a scene, and its types.
#pragma once

#include <type_traits>

#include "skinctl/cycle/detail/check_arithmetic.hpp"
#include "skinctl/cycle/detail/check_scene.hpp"
#include "skinctl/cycle/detail/scene_traits.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/cycle/output.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/tactile/coverage.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// What does not fit between the parts of a scene; a class of its own, so that the scene stays complete.
template <GuardFault Guard, bool JerkOfMotion, bool OfThisRobot, bool Feels, bool HasCells>
struct SayParts {
  static_assert(Guard != GuardFault::interface,
                "this guard is for another interface than the robot's: leave it out, a cycle builds its own");
  static_assert(Guard != GuardFault::joints,
                "this guard is for a robot with another number of joints: leave it out");
  static_assert(Guard != GuardFault::scalar, "this guard is for a robot in another scalar: leave it out");
  static_assert(JerkOfMotion,
                "a torque interface has no motion whose jerk could be limited: leave JerkLimits out");
  static_assert(OfThisRobot, "the governor is of a robot with other joints, or of another scalar");
  static_assert(Feels,
                "contact limits need a skin on each link that they name: what is not felt cannot be limited");
  static_assert(HasCells, "SkinWatch: this scene has no skin whose cells could fall silent");
};

/// Whether the parts of a scene fit together: the first base of a `Cycle`, so that an error names few layers.
template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
struct FittingParts {
  using Scene = detail::Scene<Resolver, GivenLaw, GivenSkin>;
  using Skin = typename Scene::Skin;
  static_assert(sizeof(SaySkin<Scene::skin_fault, GivenSkin>) > 0);
  static_assert(sizeof(Say<Scene::law_fault, typename Scene::Finding::Law>) > 0);
  using Said =
      SayParts<fault_in_guard<Watchman, Resolver>(), !limits_jerk<Overseer> || commands_motion<Resolver>,
               governs<Overseer, Resolver::joints, typename Resolver::scalar>, feels<Overseer, GivenSkin>,
               !watches_skin<Overseer> || (CountsCells<Skin> && !std::is_same_v<Skin, NoSkin>)>;
  static_assert(sizeof(Said) > 0);
};

/// The configuration of a `Cycle`: which parts it has.
template <class Resolver, class GivenLaw, class GivenSkin, class Watchman, class Overseer>
class CycleParts {
  using Scene = detail::Scene<Resolver, GivenLaw, GivenSkin>;

 protected:
  using Skin = typename Scene::Skin;
  using L = typename Scene::Law;

 public:
  static constexpr bool governed = !std::is_same_v<Overseer, NoGovernor>;
  static constexpr std::size_t joints = Resolver::joints;
  using scalar = typename Resolver::scalar;
  using law_type = L;
  using Goal = typename GoalType<L>::type;
  using Sensed = typename SensedBy<Skin>::type;
  static constexpr bool has_gripper = detail::has_gripper<L>;
  /// Whether it stays clear of what its input says is around: see `ClearanceAround`.
  static constexpr bool has_surroundings = requires { requires Overseer::has_surroundings; };
  using Input =
      CycleInput<joints, scalar, Goal, Sensed, std::conditional_t<has_gripper, GripperState, NoGripper>,
                 typename AroundOf<Overseer>::type>;
  using Output =
      CycleOutput<joints, scalar, terms_of<L>, std::conditional_t<has_gripper, GripperCommand, NoGripper>>;
  using Wrenches = typename Skin::Wrenches;
  using Known = typename Resolver::template Knows<L, Wrenches>;
  static constexpr bool watches_contacts =
      detail::watches_contacts<Resolver> || requires { Overseer::contact_type::links; };
  /// What the resolver takes: forces and proximities apart where they have to be told.
  using Touch = typename TouchFor<Resolver, Skin, watches_contacts>::type;

  /// The state that changes from cycle to cycle; trivially copyable.
  struct Memory {
    typename Resolver::Memory robot;
    typename L::Memory law;
    typename Watchman::Memory guard;
    typename Skin::Memory skin;
    [[no_unique_address]] typename Overseer::Memory governor;
  };

  [[nodiscard]] const Resolver& resolver() const noexcept { return resolver_; }
  [[nodiscard]] const L& law() const noexcept { return law_; }
  [[nodiscard]] const Skin& skin() const noexcept { return skin_; }
  [[nodiscard]] const Watchman& guard() const noexcept { return guard_; }
  [[nodiscard]] const Overseer& governor() const noexcept { return governor_; }

 protected:
  /// Made by every public constructor before anything else of a scene.
  struct Whole {
    Whole() { check_arithmetic<scalar>(); }
  };
  template <class V>
  [[nodiscard]] static auto given(const V& value) {
    return [&value](const Resolver&) -> const V& { return value; };
  }
  template <class Robot, class MakeGuard, class MakeGovernor>
  CycleParts(Whole, const Robot& robot, Skin&& skin, const L& law, const MakeGuard& guard,
             const MakeGovernor& governor)
      : resolver_(as_resolver(robot)),
        law_(law),
        guard_(guard(resolver_)),
        skin_(std::move(skin)),
        governor_(governor(resolver_)) {
    if constexpr (Described<Robot>) {
      check_holders<Robot, L>();
      check_settings(robot, law);
      check_contacts(robot, skin_);
    }
    if constexpr (requires { law.waits_for_contacts(); } && !requires { typename Skin::Found; })
      require(!law.waits_for_contacts(), "skills that wait for contacts, on a skin that finds none", 1,
              "a ContactSkin");
    if constexpr (limits_jerk<Overseer> && commands_motion<Resolver>) check_no_lead(resolver_);
    compare(guard_, resolver_);
  }
  /// The planned interval [s], for the laws that start or take goals between two evaluations.
  [[nodiscard]] scalar period() const noexcept { return resolver_.planned_step(); }
  /// Whether the watch over the skin holds a robot that nobody else has stopped.
  [[nodiscard]] SKINCTL_INLINE bool pauses(const Memory& m) const noexcept {
    if constexpr (watches_skin<Overseer>) {
      return governor_.watch().holds(m.governor.watch) && !resolver_.stops(m.robot);
    } else {
      return false;
    }
  }

  Resolver resolver_;
  L law_;
  Watchman guard_;
  Skin skin_;
  [[no_unique_address]] Overseer governor_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
