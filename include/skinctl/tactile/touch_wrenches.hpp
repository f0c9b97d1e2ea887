// SPDX-License-Identifier: BSD-3-Clause
// Forces and proximities of a skin as two wrenches on each link: a contact, and the controller's own push.
#pragma once

#include <type_traits>

#include "skinctl/tactile/link_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A skin's wrenches, separate for forces and proximities. A pressed cell is a contact: the world pushes, and
/// its work is the world's. A cell that only sees something is not touched: its wrench is the controller's
/// own, and an energy tank pays for it. Laws see the sum. `W` is a `LinkWrenches`.
template <class W>
struct TouchWrenches {
  using Wrenches = W;
  using model_type = typename W::model_type;
  using scalar = typename W::scalar;
  static constexpr LinkMask links = W::links;
  W force;      ///< wrenches by force readings
  W proximity;  ///< wrenches by proximity readings

  [[nodiscard]] SKINCTL_INLINE constexpr W total() const noexcept { return force + proximity; }
  friend SKINCTL_INLINE constexpr bool operator==(const TouchWrenches& a, const TouchWrenches& b) noexcept {
    return a.force == b.force && a.proximity == b.proximity;
  }
};

/// The touch that a law sees: contacts and the controller's own push together.
template <class Touch>
[[nodiscard]] SKINCTL_INLINE constexpr const Touch& total_of(const Touch& touch) noexcept {
  return touch;
}
template <class W>
[[nodiscard]] SKINCTL_INLINE constexpr W total_of(const TouchWrenches<W>& touch) noexcept {
  return touch.total();
}
/// Whether a touch has separate forces and proximities.
template <class Touch>
inline constexpr bool is_apart = false;
template <class W>
inline constexpr bool is_apart<TouchWrenches<W>> = true;
/// The part of a touch that is contact. Wrenches that are not separated, such as those of a force sensor, are
/// all contact.
template <class Touch>
[[nodiscard]] SKINCTL_INLINE constexpr const Touch& contact_part(const Touch& touch) noexcept {
  return touch;
}
template <class W>
[[nodiscard]] SKINCTL_INLINE constexpr const W& contact_part(const TouchWrenches<W>& touch) noexcept {
  return touch.force;
}

/// The type in which a law sees a touch.
template <class Touch>
using LawTouch = std::remove_cvref_t<decltype(total_of(std::declval<const Touch&>()))>;

SKINCTL_END_NAMESPACE
