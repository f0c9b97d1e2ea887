// SPDX-License-Identifier: BSD-3-Clause
// From wrenches on links to joint torques: one pass from the outermost link with skin to the base.
#pragma once

#include "skinctl/kinematics/joint_frame.hpp"
#include "skinctl/tactile/link_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Force and moment about some origin; typed zeros where there is no skin.
template <class F, class N>
struct Load {
  F force;
  N moment;

  template <class G, class O>
  SKINCTL_INLINE constexpr auto operator+(const Load<G, O>& other) const noexcept {
    const auto f = force + other.force;
    const auto n = moment + other.moment;
    return Load<std::remove_cv_t<decltype(f)>, std::remove_cv_t<decltype(n)>>{f, n};
  }
};
template <class F, class N>
Load(F, N) -> Load<F, N>;

template <std::size_t Ix, Topology M, LinkMask Skinned, class T>
SKINCTL_INLINE constexpr auto own_load(const LinkWrenches<M, Skinned, T>& wrenches) noexcept {
  if constexpr ((Skinned >> Ix) & 1u) {
    const auto F = wrenches.template wrench<Ix>();
    return Load{F.force, F.moment};
  } else {
    return Load{ZeroTriple{}, ZeroTriple{}};
  }
}

/// Writes `tau[Ix]` from the skin's wrench on the subtree of link `Ix`, and returns that wrench about the
/// parent's origin along the parent's axes.
template <std::size_t Ix, RobotModel M, class T, LinkMask A, class F, class N>
SKINCTL_INLINE constexpr auto hand_down_load(const M& model, const JointAngles<M, T, A>& angles,
                                             const Load<F, N>& load, T* tau) noexcept {
  if constexpr (M::kinds[Ix] == JointKind::revolute) {
    tau[Ix] = T(load.moment.z);
  } else {
    tau[Ix] = T(load.force.z);
  }
  const auto frame = joint_frame<Ix>(model, angles);
  const auto f = frame.to_parent(load.force);
  return Load{f, frame.to_parent(load.moment) + cross(frame.p, f)};
}

/// Writes `tau` for the subtree of link `Ix` and returns the skin's wrench on the subtree, about the parent's
/// origin along the parent's axes. A subtree without skin gives typed zeros, which leave no code.
template <std::size_t Ix, RobotModel M, class T, LinkMask A, Topology B, LinkMask Skinned>
SKINCTL_INLINE constexpr auto subtree_load(const M& model, const JointAngles<M, T, A>& angles,
                                           const LinkWrenches<B, Skinned, T>& wrenches, T* tau) noexcept {
  if constexpr ((subtree<M>(Ix) & Skinned) == 0) {
    return Load{ZeroTriple{}, ZeroTriple{}};
  } else {
    constexpr auto carried = children<M, int(Ix)>;
    if constexpr (carried.size() == 0) {
      return hand_down_load<Ix>(model, angles, own_load<Ix>(wrenches), tau);
    } else if constexpr (carried.size() == 1) {
      return hand_down_load<Ix>(
          model, angles, own_load<Ix>(wrenches) + subtree_load<carried[0]>(model, angles, wrenches, tau),
          tau);
    } else {
      const auto load = [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
        return (own_load<Ix>(wrenches) + ... + subtree_load<carried[K]>(model, angles, wrenches, tau));
      }(std::make_index_sequence<carried.size()>{});
      return hand_down_load<Ix>(model, angles, load, tau);
    }
  }
}

}  // namespace detail

/// `tau_skin = sum over cells J_cell^T [F_cell; 0]` [N m], eqs. (6), (7), from the sums of the cells'
/// wrenches on each link.
///
/// Joints beyond the last link with skin get 0 and cost nothing. Relative to the largest torque that occurs,
/// the error is a few units in the last place times the number of joints. `angles` must hold every joint on
/// the path to a link with skin. A NaN in a wrench gives NaN torques of the joints that carry it. The skin of
/// a model also serves models derived from it (`Loaded`, `Mounted`).
template <RobotModel M, class T, LinkMask A, Topology B, LinkMask Skinned>
  requires std::is_base_of_v<B, M>
[[nodiscard]] SKINCTL_INLINE constexpr JointTorque<M::joints, T> skin_torque(
    const M& model, const JointAngles<M, T, A>& angles,
    const LinkWrenches<B, Skinned, T>& wrenches) noexcept {
  static_assert((closure<M>(Skinned) & ~all_links(JointAngles<M, T, A>::count)) == 0,
                "the angles of a joint that carries skin are missing");
  JointTorque<M::joints, T> tau;
  constexpr auto roots = children<M, -1>;
  if constexpr (roots.size() == 1) {
    static_cast<void>(detail::subtree_load<roots[0]>(model, angles, wrenches, tau.data));
  } else {
    detail::for_each_link<roots>([&](auto child) SKINCTL_INLINE_LAMBDA {
      static_cast<void>(detail::subtree_load<child.value>(model, angles, wrenches, tau.data));
    });
  }
  return tau;
}
template <RobotModel M, class T, Topology B, LinkMask Skinned>
  requires std::is_base_of_v<B, M>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> skin_torque(
    const M& model, const JointPosition<M::joints, T>& q,
    const LinkWrenches<B, Skinned, T>& wrenches) noexcept {
  return skin_torque(model, JointAngles<M, T, Skinned>(model, q), wrenches);
}
/// A robot without skin (an empty type in place of the wrenches) has zero torque.
template <RobotModel M, class T, LinkMask A, class NoSkin>
  requires std::is_empty_v<NoSkin>
[[nodiscard]] SKINCTL_INLINE constexpr JointTorque<M::joints, T> skin_torque(const M&,
                                                                             const JointAngles<M, T, A>&,
                                                                             const NoSkin&) noexcept {
  return {};
}

SKINCTL_END_NAMESPACE
