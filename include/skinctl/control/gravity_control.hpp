// G Control: the robot carries its own weight, section 4.2.3.
#pragma once

#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The instant of an interval at which a law that holds its torque through it evaluates the model.
enum class GravityInstant : unsigned char { start, middle };

/// `tau = G(q)`. In a sum it keeps weight 1, appears at most once, and tells the tracking laws to leave G out
/// of `Y_r Theta`.
///
/// At the middle, `G(q + dq dt/2)`, a moving robot is carried to second order; at the start, what is held
/// lags by half an interval, but other laws share it.
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
