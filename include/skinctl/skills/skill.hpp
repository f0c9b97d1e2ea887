// A skill: which controllers it loads, what it switches, when it may start, is finished, or has failed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Discrete controls: binary outputs such as grippers, one bit each. `which` are meant, `on` says how they
/// shall be.
struct SkillSwitches {
  std::uint32_t which = 0;
  std::uint32_t on = 0;

  /// These, and where `next` means a bit, that.
  [[nodiscard]] constexpr SkillSwitches then(const SkillSwitches& next) const noexcept {
    return {which | next.which, (on & ~next.which) | (next.on & next.which)};
  }
  /// Whether all that `wanted` means stand as it says.
  [[nodiscard]] constexpr bool stand(const SkillSwitches& wanted) const noexcept {
    return (wanted.which & ~which) == 0 && ((on ^ wanted.on) & wanted.which) == 0;
  }
  friend constexpr bool operator==(const SkillSwitches&, const SkillSwitches&) noexcept = default;
};
/// Gripper `i` closes.
[[nodiscard]] constexpr SkillSwitches closed(unsigned i = 0) noexcept {
  return {1u << (i % 32), 1u << (i % 32)};
}
/// Gripper `i` opens.
[[nodiscard]] constexpr SkillSwitches opened(unsigned i = 0) noexcept {
  return {1u << (i % 32), 0};
}

/// When a skill has done its work.
enum class SkillFinish : unsigned char {
  never,     ///< it goes on until another is asked for
  settled,   ///< the targets of its tracking laws stand, and the robot stands at them
  switched,  ///< what it switches is reported to stand so; without reports after `hold`
  elapsed    ///< after `hold`
};

/// When a skill may start, is finished, or has failed.
struct SkillConditions {
  bool untouched = false;  ///< starts only while nothing touches the robot
  SkillSwitches needs{};   ///< starts only with these so, as reported or else as last commanded
  SkillFinish finish = SkillFinish::never;
  Nanoseconds hold = 100ms;  ///< for how long the finish condition holds before it counts
  double still = 0.01;       ///< settled: no joint is faster, or asked to be [rad/s]
  Nanoseconds timeout{};     ///< fails if it is not finished after this; 0: never
  double max_touch = 0;      ///< fails if the skin's joint torque exceeds this norm [N m]; 0: never
};

/// A skill as the loop reads it, for a sum of `Terms` controllers.
template <std::size_t Terms>
struct Skill {
  const char* name = "";
  std::array<double, Terms> weights{};      ///< 0: not loaded
  std::array<std::uint8_t, Terms> order{};  ///< indices of its controllers, in the order in which they load
  std::uint8_t controllers = 0;             ///< how many it loads
  std::uint8_t next = 0;                    ///< which skill follows when it is finished; itself: none
  SkillSwitches switches{};                 ///< what it switches when it starts
  SkillConditions conditions{};
};

/// What a change from one skill to another does to the controllers, in this order: those that come load as
/// the new recipe lists them; when the torque has moved over, those that go unload, last come first gone.
template <std::size_t Terms>
struct Transition {
  std::array<std::uint8_t, Terms> load{}, keep{}, unload{};
  std::uint8_t loads = 0, keeps = 0, unloads = 0;
};
template <std::size_t Terms>
[[nodiscard]] constexpr Transition<Terms> transition(const Skill<Terms>& from,
                                                     const Skill<Terms>& to) noexcept {
  Transition<Terms> out;
  for (std::uint8_t k = 0; k < to.controllers; ++k) {
    const auto i = to.order[k];
    if (from.weights[i] > 0)
      out.keep[out.keeps++] = i;
    else
      out.load[out.loads++] = i;
  }
  for (std::uint8_t k = from.controllers; k > 0; --k)
    if (const auto i = from.order[k - 1]; !(to.weights[i] > 0)) out.unload[out.unloads++] = i;
  return out;
}

/// Where a skill stands.
enum class SkillPhase : unsigned char {
  loading,   ///< the torque moves over to it
  running,   ///< it works
  finished,  ///< it has done its work and holds
  failed     ///< a failure condition has been met: the skill to fall back to comes next
};

SKINCTL_END_NAMESPACE
