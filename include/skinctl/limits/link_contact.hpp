// SPDX-License-Identifier: BSD-3-Clause
// What a link of the robot may touch, and how a contact there is measured.
#pragma once

#include <vector>

#include "skinctl/limits/body_region.hpp"
#include "skinctl/tactile/cell_place.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The kind of the limit that the `LinkContact`s of all links make together.
struct LinkContacts {};

/// The body region that link `Ix` may touch, and how a contact is measured.
template <std::size_t Ix>
struct LinkContact {
  using Kind = LinkContact;
  using Family = LinkContacts;
  static constexpr std::size_t link = Ix;
  BodyRegion region;                 ///< the most sensitive region that can be touched
  double reach = BodyRegion::unset;  ///< largest distance of the link's surface from the link's origin [m]
  /// Time from a change of force until the robot's speed changes.
  Nanoseconds reaction_time = BodyRegion::unset_time;
  double newton = 1;  ///< calibration: newtons of the contact per newton of the skin's wrench
  /// Speed and separation: while the skin detects nobody, it may allow more speed than the force limit. A
  /// limit of speed: it holds whatever an energy tank holds, where the torque of proximity readings ends.
  std::optional<Separation> separation = {};
  /// Distance at which a cell begins to detect [m]; the measured distance is `range (1 - proximity)`. Choose
  /// it so that this lies below the sensor's own curve. Needed with `separation`.
  double range = 0;
  /// Smallest deceleration of any point of the link once it reacts [m/s^2]. If it is given, contacts count as
  /// those of drives that do not give way before they react, and then brake; see `ContactLimits`.
  double deceleration = BodyRegion::unset;
  /// The skin's cells (`skin.places()`; those of other links are ignored). If they are given, only collisions
  /// of cells along their normals count, each with the mass felt there, instead of the bound for any point.
  std::vector<CellPlace> cells = {};
};

SKINCTL_END_NAMESPACE
