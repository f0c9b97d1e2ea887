// SPDX-License-Identifier: BSD-3-Clause
// Skin Joint Control: the robot gives way to touch, section 4.1.
#pragma once

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/tactile/skin_torque.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `tau = tau_skin`, eq. (7): the wrenches of the skin on the links, as joint torques. Zero in a scene
/// without skin. Its weight in a sum scales the felt mass at the contact and is not normalised.
struct SkinJointControl : StatelessLaw<SkinJointControl> {
  static constexpr Needs needs = {.angles = true, .touch = true};
  static constexpr const char* name = "skin_joint";

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const K& known) const noexcept {
    if constexpr (std::is_same_v<typename K::touch_type, NoTouch>) {
      return {};
    } else {
      return skin_torque(known.model(), known.angles(), known.touch());
    }
  }
};

SKINCTL_END_NAMESPACE
