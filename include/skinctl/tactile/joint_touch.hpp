// SPDX-License-Identifier: BSD-3-Clause
// Touch that is known only as joint torques: what an observer of the motors finds.
#pragma once

#include "skinctl/tactile/contact.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The torque of contacts at unknown places [N m]: what `skin_torque` of their wrenches would be.
template <Topology M, Scalar T = double>
struct JointTouch {
  using model_type = M;
  using scalar = T;
  static constexpr LinkMask links = 0;  ///< no link's wrench is known
  JointTorque<M::joints, T> torque;

  friend SKINCTL_INLINE constexpr bool operator==(const JointTouch& a, const JointTouch& b) noexcept {
    return a.torque == b.torque;
  }
};

/// The lever assumed for a contact at an unknown place [m]: a torque of 1 N m counts as a contact of 2 N.
template <class T>
inline constexpr T assumed_lever = T(0.5);

template <RobotModel M, class Angles, Topology B, class T>
  requires std::is_base_of_v<B, M>
[[nodiscard]] SKINCTL_INLINE constexpr const JointTorque<M::joints, T>& skin_torque(
    const M&, const Angles&, const JointTouch<B, T>& touch) noexcept {
  return touch.torque;
}

/// One contact with the joint torque of `touch`, its force as if it had `assumed_lever`; none for less than
/// `least` [N], or a torque that is not finite. `link` is that of the outermost joint that feels it.
template <RobotModel M, Topology B, Real T>
  requires std::is_base_of_v<B, M>
[[nodiscard]] auto contacts_of(const M&, const JointPosition<M::joints, T>&, const JointTouch<B, T>& touch,
                               const T& least = T(1e-3)) noexcept {
  using std::sqrt;
  Contacts<M::joints, T, 1> out;
  T square(0);
  for (std::size_t i = 0; i < M::joints; ++i) square = square + touch.torque[i] * touch.torque[i];
  const T force = sqrt(square) / assumed_lever<T>;
  if (!(force >= least) || !(force <= std::numeric_limits<T>::max())) return out;
  auto& contact = out.list[out.count++];
  contact.force = force;
  for (std::size_t i = 0; i < M::joints; ++i) {
    contact.row[i] = -touch.torque[i] / force;
    if (touch.torque[i] != T(0)) contact.link = i;
  }
  return out;
}

SKINCTL_END_NAMESPACE
