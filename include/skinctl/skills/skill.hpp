// SPDX-License-Identifier: BSD-3-Clause
// A skill: the controllers that it loads, its switches, its conditions to start, finish and fail.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "skinctl/core/gripper.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Discrete controls: binary outputs such as grippers, one bit each. `which` selects bits, `on` gives their
/// values.
struct SkillSwitches {
  std::uint32_t which = 0;
  std::uint32_t on = 0;

  /// A copy of these switches in which the bits that `next` selects have its values.
  [[nodiscard]] constexpr SkillSwitches then(const SkillSwitches& next) const noexcept {
    return {which | next.which, (on & ~next.which) | (next.on & next.which)};
  }
  /// Whether all bits that `wanted` selects have its values.
  [[nodiscard]] constexpr bool stand(const SkillSwitches& wanted) const noexcept {
    return (wanted.which & ~which) == 0 && ((on ^ wanted.on) & wanted.which) == 0;
  }
  friend constexpr bool operator==(const SkillSwitches&, const SkillSwitches&) noexcept = default;
};
/// The switch that closes gripper `i`.
[[nodiscard]] constexpr SkillSwitches closed(unsigned i = 0) noexcept {
  return {1u << (i % 32), 1u << (i % 32)};
}
/// The switch that opens gripper `i`.
[[nodiscard]] constexpr SkillSwitches opened(unsigned i = 0) noexcept {
  return {1u << (i % 32), 0};
}

/// The condition under which a skill is finished.
enum class SkillFinish : unsigned char {
  never,     ///< the skill goes on until another one is requested
  settled,   ///< the targets of its tracking laws are at rest, and so is the robot; with a tolerance: the
             ///< robot is within it of the goals of its request, at rest or not
  gripped,   ///< the gripper has stopped at an object; fails if it stops without one
  opened,    ///< the gripper has stopped at its goal, or at an object
  switched,  ///< the switches are reported in their new positions; without reports after `hold`
  touched,   ///< a contact that meets `touch` presses
  released,  ///< a contact that meets `touch` has pressed while the skill ran, and none does now
  elapsed    ///< `hold` has passed
};

/// A contact of a `ContactSkin` for which a skill waits.
struct TouchCondition {
  /// Mask of regions, `regions().mask("palm")`, one of which is touched; all bits: anywhere.
  std::uint32_t regions = ~std::uint32_t(0);
  double force = 0;     ///< smallest push of the contact [N]
  Nanoseconds lasts{};  ///< shortest time that one contact is felt

  /// Whether one of `contacts` meets this condition at `now`.
  template <class Contacts>
  [[nodiscard]] constexpr bool holds(const Contacts& contacts, Nanoseconds now) const noexcept {
    for (const auto& c : contacts)
      if ((regions == ~std::uint32_t(0) || (c.regions & regions) != 0) &&
          static_cast<double>(c.pushed) >= force && now - c.began >= lasts)
        return true;
    return false;
  }
};

/// The largest distances from its goals at which a skill is finished; 0: not checked. See
/// `SkillFinish::settled`.
struct GoalTolerance {
  double position = 0;     ///< largest position error of a pose [m]
  double orientation = 0;  ///< largest orientation error of a pose [rad]
  double joint = 0;        ///< largest position error of a joint [rad]

  [[nodiscard]] constexpr bool any() const noexcept { return position > 0 || orientation > 0 || joint > 0; }
  template <class F>
  friend void each_number(GoalTolerance& t, F&& f) {
    f(t.position), f(t.orientation), f(t.joint);
  }
};

/// Conditions under which a skill may start, is finished, or has failed.
struct SkillConditions {
  bool untouched = false;  ///< whether the skill starts only while nothing touches the robot
  SkillSwitches needs{};   ///< switch values required to start, as reported or else as last commanded
  SkillFinish finish = SkillFinish::never;
  Nanoseconds hold = 100ms;   ///< time for which the finish condition must hold
  TouchCondition touch{};     ///< contact that `touched` and `released` wait for
  double still = 0.01;        ///< settled: largest speed of any joint and of its reference [rad/s]
  Nanoseconds timeout{};      ///< time after which a skill that is not finished fails; 0: never
  GoalTolerance tolerance{};  ///< tolerance of `settled`, unless a request has its own
  double max_touch = 0;       ///< norm of the skin's joint torque above which the skill fails [N m]; 0: never
};

/// A skill as the loop reads it, for a sum of `Terms` controllers.
template <std::size_t Terms>
struct Skill {
  const char* name = "";
  std::array<double, Terms> weights{};      ///< weights in the sum; 0: not loaded
  std::array<std::uint8_t, Terms> order{};  ///< indices of its controllers, in the order in which they load
  std::uint8_t controllers = 0;             ///< number of controllers
  std::uint8_t next = 0;     ///< index of the skill that follows when it is finished; its own index: none
  SkillSwitches switches{};  ///< switches that are set when the skill starts
  SkillConditions conditions{};
  bool grips = false;  ///< whether the gripper gets a goal when the skill starts
  GripperGoal grip{};  ///< goal of the gripper if `grips`, unless a request has its own
};

/// The phase of a skill.
enum class SkillPhase : unsigned char {
  loading,   ///< the torque changes over to the skill
  running,   ///< the skill works
  finished,  ///< the skill has finished and holds
  failed     ///< a failure condition has been met: the fallback skill follows
};

/// The reason for which a request for a skill has failed.
enum class SkillFailure : unsigned char {
  none,
  conditions,  ///< refused: the conditions under which the skill may start did not hold
  goal,        ///< refused: a controller did not take the goal
  timeout,     ///< the skill did not finish in time
  touch,       ///< the skin's torque has exceeded `max_touch`
  empty,       ///< the gripper has closed on nothing, or lost what it held
  gripper,     ///< the gripper reports an error
  next         ///< the next skill of its sequence might not start
};
[[nodiscard]] constexpr const char* describe(SkillFailure failure) noexcept {
  switch (failure) {
    case SkillFailure::none:
      return "has not failed";
    case SkillFailure::conditions:
      return "its conditions to start did not hold";
    case SkillFailure::goal:
      return "its goal was refused";
    case SkillFailure::timeout:
      return "not finished in time";
    case SkillFailure::touch:
      return "touched too hard";
    case SkillFailure::empty:
      return "nothing is in the gripper";
    case SkillFailure::gripper:
      return "the gripper does not work";
    case SkillFailure::next:
      return "the next skill might not start";
  }
  return "";
}

/// The state of a request, by the number that it carried (`SkillRequest::ticket`).
struct SkillReport {
  std::uint16_t ticket = 0;  ///< number of the request that the report is about; 0: none
  SkillPhase phase = SkillPhase::loading;
  SkillFailure failure = SkillFailure::none;  ///< reason, if the request has failed
  friend constexpr bool operator==(const SkillReport&, const SkillReport&) noexcept = default;
};

SKINCTL_END_NAMESPACE
