// The scene of the controller.
#pragma once

#include <array>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace skinctl_controller {

inline constexpr std::array<const char*, 6> joint_names = {"shoulder_pan_joint", "shoulder_lift_joint",
                                                           "elbow_joint",        "wrist_1_joint",
                                                           "wrist_2_joint",      "wrist_3_joint"};

/// Skin and gravity: the arm is led by hand.
inline auto make_scene() {
  using namespace skinctl;
  return Cycle(
      by_position(
          ur5::Model{},
          {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4}),
      ur5_skin<260>({.force = 40}), SkinJointControl{} + GravityControl{});
}

}  // namespace skinctl_controller
