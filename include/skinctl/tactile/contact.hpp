// SPDX-License-Identifier: BSD-3-Clause
// Contacts as seen by the joints.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "skinctl/tactile/pressed_area.hpp"
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
  Xyz<T> place = {T(0), T(0), T(0)};   ///< touched point, from the link's origin along its axes [m]
  Xyz<T> normal = {T(0), T(0), T(0)};  ///< unit vector of the push, along the link's axes

  /// Displacement of the touched point into the contact [m], `row . dq`; of a joint velocity its speed [m/s].
  template <class Q>
  [[nodiscard]] SKINCTL_INLINE T along(const Q& dq) const noexcept {
    T sum(0);
    for (std::size_t i = 0; i < N; ++i) sum = sum + row[i] * dq[i];
    return sum;
  }
};

/// Maximum number of contacts of a robot with `N` links: see `PressedAreas`.
template <std::size_t N>
inline constexpr std::size_t max_contacts = N + 6;

/// A list of up to `K` contacts, several of them on one link if need be.
template <std::size_t N, Real T, std::size_t K>
struct Contacts {
  Contact<N, T> list[K];
  std::size_t count = 0;

  [[nodiscard]] SKINCTL_INLINE const Contact<N, T>* begin() const noexcept { return list; }
  [[nodiscard]] SKINCTL_INLINE const Contact<N, T>* end() const noexcept { return list + count; }
};

namespace detail {

/// Index of the contact remembered from the last cycle that `c` continues: the nearest one on its link whose
/// push is within 60 degrees of that of `c`; `count` if there is none. `taken[k]` excludes contact k.
template <class Remembered, std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE std::size_t continued(const Remembered* list, const bool* taken,
                                                   std::size_t count, const Contact<N, T>& c) noexcept {
  std::size_t best = count;
  T least(0);
  for (std::size_t k = 0; k < count; ++k) {
    if (taken[k] || list[k].link != c.link) continue;
    const Xyz<T> turn = list[k].normal - c.normal, way = list[k].place - c.place;
    const T far = dot(way, way);
    if (dot(turn, turn) <= T(1) && (best == count || far < least)) best = k, least = far;
  }
  return best;
}

/// Distance from each link's origin within which its surface is assumed to lie where no skin tells it [m]:
/// the larger of the distance of the next joint and twice that of the centre of mass, plus 0.4 m for covers
/// and tools.
template <RobotModel M, Real T>
[[nodiscard]] SKINCTL_INLINE std::array<T, M::joints> assumed_reach(const M& model) noexcept {
  using std::sqrt;
  using P = LinkParameter;
  std::array<T, M::joints> reach{};
  const auto extend = [&](std::size_t i, const T& x, const T& y, const T& z) {
    const T far = sqrt(x * x + y * y + z * z) + T(0.4);
    if (far > reach[i]) reach[i] = far;
  };
  [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
    const auto look = [&]<std::size_t J>(std::integral_constant<std::size_t, J>) {
      extend(J, T(2) * T(model.template number<J, P::c_x, T>()),
             T(2) * T(model.template number<J, P::c_y, T>()),
             T(2) * T(model.template number<J, P::c_z, T>()));
      if constexpr (M::parents[J] >= 0)
        extend(std::size_t(M::parents[J]), T(model.template number<J, P::p_x, T>()),
               T(model.template number<J, P::p_y, T>()), T(model.template number<J, P::p_z, T>()));
    };
    (look(std::integral_constant<std::size_t, Ix>{}), ...);
  }(std::make_index_sequence<M::joints>{});
  return reach;
}

/// The contact of the force `push` [N] on a link at `place` [m], along the link's axes; `moment` is about the
/// link's origin [N m], `force` the magnitude of `push`.
template <LinkMask Skinned, RobotModel M, LinkMask A, Real T>
[[nodiscard]] SKINCTL_INLINE Contact<M::joints, T> contact_of(const M& model,
                                                              const JointAngles<M, T, A>& angles,
                                                              std::size_t link, const Xyz<T>& place,
                                                              const Xyz<T>& push, const Xyz<T>& moment,
                                                              const T& force) noexcept {
  LinkWrenches<M, Skinned, T> one;
  T* w = one.data[one.slot(link)];
  w[0] = push.x, w[1] = push.y, w[2] = push.z;
  w[3] = moment.x, w[4] = moment.y, w[5] = moment.z;
  const JointTorque<M::joints, T> tau = skin_torque(model, angles, one);
  const T per_force = T(1) / force;
  Contact<M::joints, T> c{link, force, {}, place, per_force * push};
  for (std::size_t j = 0; j < M::joints; ++j) c.row[j] = -tau[j] * per_force;
  return c;
}

}  // namespace detail

/// The contacts of a robot at `q`, one for each pressed area. The lever of a push about its link's origin is
/// at most twice the distance of the link's farthest cell. An area whose total force is below `least` [N] is
/// no contact.
template <RobotModel M, Topology B, LinkMask Skinned, Real T>
[[nodiscard]] auto contacts_of(const M& model, const JointPosition<M::joints, T>& q,
                               const PressedAreas<B, Skinned, T>& areas, const T& least = T(1e-3)) noexcept {
  using std::sqrt;
  Contacts<M::joints, T, PressedAreas<B, Skinned, T>::most> out;
  if (areas.size() == 0) return out;
  const JointAngles<M, T, Skinned> angles(model, q);
  for (const PressedArea<T>& a : areas) {
    const T force = sqrt(dot(a.force, a.force));
    if (!(force >= least)) continue;
    // Cells that push against each other, joined for want of room: their centre is on the link all the same.
    const bool opposed = force < T(0.5) * a.pushed;
    out.list[out.count++] = detail::contact_of<Skinned>(model, angles, a.link, a.place, a.force,
                                                        opposed ? cross(a.place, a.force) : a.moment, force);
  }
  return out;
}

/// The contacts for wrenches whose cells are not known, such as those of a force sensor: one for each link,
/// along its force. A couple of opposite pushes has no place: where the force would have to act further off
/// than the link can reach, it acts there, and the rest of the moment is in no contact. A link whose force is
/// below `least` [N] has no contact, nor has one whose wrench is not finite.
template <RobotModel M, Topology B, LinkMask Skinned, Real T>
[[nodiscard]] auto contacts_of(const M& model, const JointPosition<M::joints, T>& q,
                               const LinkWrenches<B, Skinned, T>& wrenches,
                               const T& least = T(1e-3)) noexcept {
  using std::sqrt;
  using Wrenches = LinkWrenches<B, Skinned, T>;
  Contacts<M::joints, T, Wrenches::count == 0 ? 1 : Wrenches::count> out;
  const auto touched = [&](const T* w) SKINCTL_INLINE_LAMBDA {
    const T square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    const T moment = w[3] + w[4] + w[5];
    return square >= least * least && square <= std::numeric_limits<T>::max() && moment - moment == T(0);
  };
  bool any = false;
  for (std::size_t k = 0; k < Wrenches::count; ++k) any = any || touched(wrenches.data[k]);
  if (!any) return out;
  const JointAngles<M, T, Skinned> angles(model, q);
  const auto reach = detail::assumed_reach<M, T>(model);
  for (std::size_t i = 0; i < M::joints; ++i) {
    if (((Skinned >> i) & 1u) == 0) continue;
    const T* w = wrenches.data[Wrenches::slot(i)];
    if (!touched(w)) continue;
    const Xyz<T> push{w[0], w[1], w[2]};
    Xyz<T> moment{w[3], w[4], w[5]};
    const T force = sqrt(dot(push, push));
    Xyz<T> place = (T(1) / (force * force)) * cross(push, moment);
    if (dot(moment, moment) > reach[i] * reach[i] * force * force) {
      const T far = sqrt(dot(place, place));
      if (far > reach[i]) place = (reach[i] / far) * place;
      moment = cross(place, push);
    }
    out.list[out.count++] = detail::contact_of<Skinned>(model, angles, i, place, push, moment, force);
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
