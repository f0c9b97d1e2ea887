// SPDX-License-Identifier: BSD-3-Clause
// Integrators of the virtual robot's velocity over a sub-step.
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/law/needs.hpp"
#include "skinctl/robot/robot_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Crank-Nicolson at the midpoint: M, C and G at the pose half a sub-step ahead, friction by the mean of old
/// and new velocity, C at the velocity half a sub-step ahead by the last acceleration. Second order. Where
/// friction is stiff (`z = h B/M` large, a wrist) the mean is weighted towards the new velocity so that it
/// decays as `1/(1 + z + z^2/2 + z^3/6)` instead of ringing: weight `(z^2 + 2z + 3)/(z^2 + 3z + 6)`, 1/2 as z
/// goes to 0. It computes M and C itself: those of the laws, at the start of the sub-step, are of no use. G
/// is taken at the start if a law reads it there, so that compensated gravity cancels.
struct CrankNicolson {
  using RobotPart = detail::IntegratorPart;
  static constexpr Needs needs{.middle = true};
  static constexpr bool midpoint = true;
  /// The weight of the new velocity in the friction, for numbers or rows of joints, by `b = h B` >= 0 and the
  /// mass `m` > 0. With one division: it is waited for.
  template <class Z>
  static SKINCTL_INLINE Z weight(const Z& b, const Z& m) noexcept {
    return (b * (b + Z(2) * m) + Z(3) * (m * m)) / (b * (b + Z(3) * m) + Z(6) * (m * m));
  }
};

/// Everything at the start of the sub-step, friction by the old velocity: semi-implicit Euler as commonly
/// understood. First order. Where that would ring (`z = h B/M > 1`) friction stops the joint instead: weight
/// `1 - 1/z`. Shares the quantities that laws need.
struct SemiImplicitEuler {
  using RobotPart = detail::IntegratorPart;
  static constexpr Needs needs{.angles = true};
  static constexpr bool midpoint = false;
  /// The weight of the new velocity in the friction: 0, or `1 - m/b` where `b = h B` is above the mass `m`.
  template <class Z>
  static SKINCTL_INLINE Z weight(const Z& b, const Z& m) noexcept {
    const auto fast = b > m;
    return select(fast, Z(1) - m / select(fast, b, Z(1)), Z(0.0));
  }
};

SKINCTL_END_NAMESPACE
