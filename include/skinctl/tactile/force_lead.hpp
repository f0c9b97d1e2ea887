// SPDX-License-Identifier: BSD-3-Clause
// The touch as it will be when the robot answers it.
#pragma once

#include <concepts>

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/tactile/joint_touch.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The touch `touch + factor * change`, number by number, of two touches of one type.
template <Topology M, LinkMask Skinned, Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr LinkWrenches<M, Skinned, T> led_by(
    const LinkWrenches<M, Skinned, T>& touch, const T& factor,
    const LinkWrenches<M, Skinned, T>& change) noexcept {
  LinkWrenches<M, Skinned, T> out;
  for (std::size_t k = 0; k < out.count; ++k)
    for (std::size_t r = 0; r < 6; ++r) out.data[k][r] = touch.data[k][r] + factor * change.data[k][r];
  return out;
}
template <Topology M, Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr JointTouch<M, T> led_by(const JointTouch<M, T>& touch, const T& factor,
                                                               const JointTouch<M, T>& change) noexcept {
  JointTouch<M, T> out;
  for (std::size_t i = 0; i < M::joints; ++i) out.torque[i] = touch.torque[i] + factor * change.torque[i];
  return out;
}
/// Whether the touch `W` may change: true of all but that of a scene without skin.
template <class W>
inline constexpr bool can_be_led = !std::same_as<W, NoTouch>;

/// Force lead. A robot answers a touch a time T later: by its delay, its lag and its period. Against a
/// contact of stiffness k that takes a damping of `k T` away. A law therefore gets
///
///     w + T dw/dt
///
/// with w [N, N m] the mean touch of a sub-step and dw/dt its change since the last one, by the length of a
/// sub-step: a force that changes with the motion tells the stiffness, and gives the damping back. It keeps
/// its sign and is taken of the wrenches on links: of single cells, or cut off at zero, it would add energy.
/// A touch that stays is felt as it is; over any time the lead gives the impulse `T (w_end - w_begin)`. A
/// virtual robot that dry friction holds gets the touch as it is: there is no motion to damp.
///
/// @tparam W  the touch that laws read.
template <class W>
class TouchChange {
 public:
  struct Memory {
    W before;            ///< mean touch of the last sub-step
    bool known = false;  ///< whether `before` has been set
  };

  /// The change from the last sub-step's mean touch to `now`, which replaces it; zero for the first one.
  [[nodiscard]] static SKINCTL_INLINE W next(Memory& m, const W& now) noexcept {
    using T = typename W::scalar;
    const W out = m.known ? led_by(now, T(-1), m.before) : led_by(now, T(-1), now);
    m.before = now;
    m.known = true;
    return out;
  }
};

SKINCTL_END_NAMESPACE
