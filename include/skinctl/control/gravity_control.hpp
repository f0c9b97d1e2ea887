// SPDX-License-Identifier: BSD-3-Clause
// G Control: the robot carries its own weight, section 4.2.3.
#pragma once

#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The instant of an interval at which a law evaluates the model for the torque that it holds through the
/// interval.
enum class GravityInstant : unsigned char { start, middle };

/// `tau = G(q)`. In a sum it keeps weight 1 and appears at most once, and the tracking laws leave G out of
/// `Y_r Theta`.
///
/// At the middle, `G(q + dq dt/2)`, gravity of a moving robot is compensated to second order; at the start
/// the torque lags by half an interval, but shares the model's evaluation with other laws.
template <GravityInstant At = GravityInstant::middle>
struct GravityCompensation : StatelessLaw<GravityCompensation<At>> {
  static constexpr Needs needs = {.gravity = At == GravityInstant::start,
                                  .middle = At == GravityInstant::middle};
  static constexpr LawRole role = LawRole::gravity;
  static constexpr const char* name = "gravity";

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const K& known) const noexcept {
    if constexpr (At == GravityInstant::start) {
      return known.gravity();
    } else {
      return gravity_torque(known.model(), known.middle());
    }
  }
};

using GravityControl = GravityCompensation<>;

SKINCTL_END_NAMESPACE
