// What the wrong programs get right: a robot, and a law of one's own.
//
// Promise: wrong frames, kinds and compositions do not compile, and the error names the cause
// Tried: at most 20 lines, the first names the cause, with every header included; target `wrong_programs`
// prints all of them. Also: `compile_fail/`

#pragma once

#include "skinctl/skinctl.hpp"

using namespace skinctl;

/// A UR5 by position.
inline auto sound_arm() {
  return by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
}

/// A law that pushes with nothing. A program that is wrong in one member hides it.
struct SoundLaw : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};
