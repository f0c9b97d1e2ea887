// Contacts as seen by the joints: one push per link.
#pragma once

#include <cmath>

#include "skinctl/tactile/skin_torque.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A push on link `link`: `force` >= 0 [N], and `row`, the displacement of the touched point into the contact
/// (against the push) per displacement of the joints, `dx = row . dq` [m/rad]. The push is the joint torque
/// `-force * row`.
template <std::size_t N, Real T = double>
struct Contact {
  std::size_t link = 0;
  T force = T(0);
  T row[N] = {};

  /// `row . dq` [m]; of a velocity [m/s].
  template <class Q>
  [[nodiscard]] SKINCTL_INLINE T along(const Q& dq) const noexcept {
    T sum(0);
    for (std::size_t i = 0; i < N; ++i) sum = sum + row[i] * dq[i];
    return sum;
  }
};

/// Up to `K` contacts, on different links.
template <std::size_t N, Real T, std::size_t K>
struct Contacts {
  Contact<N, T> list[K];
  std::size_t count = 0;

  [[nodiscard]] SKINCTL_INLINE const Contact<N, T>* begin() const noexcept { return list; }
  [[nodiscard]] SKINCTL_INLINE const Contact<N, T>* end() const noexcept { return list + count; }
};

/// The skin's wrenches as contacts of a robot at `q`: a link's force is one push along its direction. A link
/// whose force is below `least` [N] has no contact, nor has one whose wrench is not finite.
template <RobotModel M, LinkMask Skinned, Real T>
[[nodiscard]] auto contacts_of(const M& model, const JointPosition<M::joints, T>& q,
                               const LinkWrenches<M, Skinned, T>& wrenches,
                               const T& least = T(1e-3)) noexcept {
  using std::sqrt;
  using Wrenches = LinkWrenches<M, Skinned, T>;
  Contacts<M::joints, T, Wrenches::count == 0 ? 1 : Wrenches::count> out;
  for (std::size_t i = 0; i < M::joints; ++i) {
    if (((Skinned >> i) & 1u) == 0) continue;
    const std::size_t slot = Wrenches::slot(i);
    const T* w = wrenches.data[slot];
    const T force = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    if (!(force >= least) || !(force <= std::numeric_limits<T>::max())) continue;
    Wrenches one;
    for (std::size_t r = 0; r < 6; ++r) one.data[slot][r] = w[r];
    const JointTorque<M::joints, T> tau = skin_torque(model, q, one);
    auto& contact = out.list[out.count++];
    contact.link = i;
    contact.force = force;
    for (std::size_t j = 0; j < M::joints; ++j) contact.row[j] = -tau[j] / force;
  }
  return out;
}
/// A robot without skin has no contacts.
template <RobotModel M, Real T, class NoSkin>
  requires std::is_empty_v<NoSkin>
[[nodiscard]] Contacts<M::joints, T, 1> contacts_of(const M&, const JointPosition<M::joints, T>&,
                                                    const NoSkin&) noexcept {
  return {};
}

SKINCTL_END_NAMESPACE
