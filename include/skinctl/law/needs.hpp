// SPDX-License-Identifier: BSD-3-Clause
// The model quantities that a law needs, as a compile-time value: the cycle computes their union once and
// nothing else.
#pragma once

#include "skinctl/core/link_mask.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Quantities at the state at which a law is evaluated. Structural, so that it can be a template argument;
/// `a | b` is the union. A law declares its own as `static constexpr Needs needs`; `complete()` adds the
/// dependencies.
struct Needs {
  LinkMask poses = 0;         ///< links whose pose `X_BaseLink` a law reads
  LinkMask jacobians = 0;     ///< links whose Jacobian, or that of a frame fixed to them, a law reads
  bool angles = false;        ///< sines and cosines of the joint angles
  bool gravity = false;       ///< gravity torques G(q)
  bool mass = false;          ///< mass matrix M(q)
  bool mass_factors = false;  ///< mass matrix M(q), factorised: accelerations of torques
  bool coriolis = false;      ///< Coriolis and centrifugal torques C(q, dq) dq
  bool touch = false;         ///< wrenches of the skin on the links
  bool middle = false;        ///< sines and cosines half an interval ahead, at `q + dq dt/2`

  friend constexpr Needs operator|(const Needs& a, const Needs& b) noexcept {
    return {.poses = a.poses | b.poses,
            .jacobians = a.jacobians | b.jacobians,
            .angles = a.angles || b.angles,
            .gravity = a.gravity || b.gravity,
            .mass = a.mass || b.mass,
            .mass_factors = a.mass_factors || b.mass_factors,
            .coriolis = a.coriolis || b.coriolis,
            .touch = a.touch || b.touch,
            .middle = a.middle || b.middle};
  }
  friend constexpr bool operator==(const Needs&, const Needs&) noexcept = default;

  /// Whether any of the quantities needs the masses of all links.
  constexpr bool any_mass() const noexcept { return gravity || mass || mass_factors || coriolis; }
  /// Whether this set includes all quantities of `b`.
  constexpr bool cover(const Needs& b) const noexcept { return (*this | b) == *this; }
};

SKINCTL_END_NAMESPACE
