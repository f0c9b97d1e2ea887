// SPDX-License-Identifier: BSD-3-Clause
// Gravity torques, and the potential energy from which they derive.
#pragma once

#include "skinctl/dynamics/detail/recursion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The weight of a subtree on the link that carries it, in that link's axes: its mass, the first moment of
/// mass about its own origin, the mass times the position of that origin, and the moment of its weight about
/// its own z axis.
template <class Mass, class H, class At, class N>
struct Weight {
  Mass mass;
  H h;
  At at;
  N moment_z;
};
template <class Mass, class H, class At, class N>
Weight(Mass, H, At, N) -> Weight<Mass, H, At, N>;

/// Whether the z axis of link `Ix` is known to be parallel to that of its parent.
template <std::size_t Ix, RobotModel M, Scalar T>
constexpr bool parallel_to_parent() noexcept {
  using Sin = decltype(std::declval<const M&>().template number<Ix, LinkParameter::sin_alpha, T>());
  using Cos = decltype(std::declval<const M&>().template number<Ix, LinkParameter::cos_alpha, T>());
  return is_zero<Sin> && std::is_same_v<Cos, TypedConstant<1>>;
}

/// Writes `tau[Ix]` for the subtree of link `Ix` under the gravitational acceleration `g_parent` (parent's
/// axes) and returns the subtree's weight in the parent's axes. About parallel axes the moment of a weight
/// differs only by the offset between them, so a link adds that difference to its child's moment; if the
/// first moment is then unused, the compiler drops it.
template <std::size_t Ix, Scalar T, RobotModel M, class Angles, class G>
SKINCTL_INLINE constexpr auto subtree_gravity(const M& model, const Angles& angles, const G& g_parent,
                                              T* tau) noexcept {
  constexpr auto carried = children<M, int(Ix)>;
  const auto frame = joint_frame<Ix>(model, angles);
  const auto g = frame.to_link(g_parent);
  const auto moment_z = [&](const auto& h) SKINCTL_INLINE_LAMBDA { return h.x * g.y - h.y * g.x; };
  const auto own_mass = model.template number<Ix, LinkParameter::mass, T>();
  const auto own_h = own_mass * centre_of_mass<Ix, T>(model);
  const auto in_parent = [&](const auto& mass, const auto& h, const auto& n) SKINCTL_INLINE_LAMBDA {
    tau[Ix] = M::kinds[Ix] == JointKind::revolute ? T(-n) : T(-(mass * g.z));
    return Weight{mass, frame.to_parent(h), mass * frame.p, n};
  };
  if constexpr (carried.size() == 0) {
    return in_parent(own_mass, own_h, moment_z(own_h));
  } else if constexpr (carried.size() == 1) {
    const auto part = subtree_gravity<carried[0], T>(model, angles, g, tau);
    const auto fixed = own_h + part.at;
    if constexpr (parallel_to_parent<carried[0], M, T>()) {
      return in_parent(own_mass + part.mass, fixed + part.h, moment_z(fixed) + part.moment_z);
    } else {
      const auto h = fixed + part.h;
      return in_parent(own_mass + part.mass, h, moment_z(h));
    }
  } else {
    T mass(own_mass);
    auto h = dense<T>(own_h);
    for_each_link<carried>([&](auto child) SKINCTL_INLINE_LAMBDA {
      const auto part = subtree_gravity<child.value, T>(model, angles, g, tau);
      mass = mass + part.mass;
      h = dense<T>(h + part.at + part.h);
    });
    return in_parent(mass, h, moment_z(h));
  }
}

/// Joints on whose angle G does not depend, according to the types of the model: the first of a chain if its
/// axis is vertical, and the last of a branch if its link's centre of mass lies on the axis.
template <RobotModel M, Scalar T>
constexpr LinkMask weightless_angles() noexcept {
  using P = LinkParameter;
  using Gravity = decltype(std::declval<const M&>().template gravity<T>());
  LinkMask mask = 0;
  unrolled<M::joints>([&](auto i) {
    using Tilt = decltype(std::declval<const M&>().template number<i, P::sin_alpha, T>());
    using X = decltype(std::declval<const M&>().template number<i, P::c_x, T>());
    using Y = decltype(std::declval<const M&>().template number<i, P::c_y, T>());
    const bool upright =
        M::parents[i] < 0 && is_zero<Tilt> && is_zero<decltype(Gravity::x)> && is_zero<decltype(Gravity::y)>;
    const bool balanced = children<M, int(i)>.size() == 0 && is_zero<X> && is_zero<Y>;
    if (M::kinds[i] == JointKind::revolute && (upright || balanced)) mask |= LinkMask(1) << i;
  });
  return mask;
}

/// G(q) from sines and cosines that may omit those of `weightless_angles`.
template <Scalar T, RobotModel M, class Angles>
SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque_from(const M& model, const Angles& angles) noexcept {
  return JointTorque<M::joints, T>::written([&](T* tau) SKINCTL_INLINE_LAMBDA {
    const auto g = model.template gravity<T>();
    constexpr auto roots = children<M, -1>;
    if constexpr (roots.size() == 1) {
      static_cast<void>(subtree_gravity<roots[0], T>(model, angles, g, tau));
    } else {
      for_each_link<roots>([&](auto child) SKINCTL_INLINE_LAMBDA {
        static_cast<void>(subtree_gravity<child.value, T>(model, angles, g, tau));
      });
    }
  });
}

}  // namespace detail

/// The torques `G(q)` [N m] that hold the robot against gravity: `G = dV/dq` of the potential energy. Of a
/// UR5 within 4.7e-14 N m (float: 3.0e-5) of the exact ones at every state (proven, `bench/studies/bounds`).
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque(
    const M& model, const JointAngles<M, T, Mask>& angles) noexcept {
  return detail::gravity_torque_from<T>(model, angles);
}
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque(
    const M& model, const JointPosition<M::joints, T>& q) noexcept {
  constexpr LinkMask all = all_links(M::joints);
  return detail::gravity_torque_from<T>(model,
                                        JointAngles<M, T, all, detail::weightless_angles<M, T>()>(model, q));
}
// clang-format off
template <RobotModel M, Scalar T> requires(!computes_in<M, T>)
void gravity_torque(const M&, const JointPosition<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
template <RobotModel M, class... Q> requires(any_eigen<Q...>)
void gravity_torque(const M&, const Q&...) = delete;  // an Eigen vector has no kind: name it, JointPosition<N>(v)
// clang-format on

/// Potential energy `V(q) = -g . sum m_i r_i` [J], zero with all mass at the base's origin.
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE T potential_energy(const M& model,
                                                const JointPosition<M::joints, T>& q) noexcept {
  JointTorque<M::joints, T> unused;
  const JointAngles<M, T> angles(model, q);
  const auto g = model.template gravity<T>();
  T energy(0);
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    const auto part = detail::subtree_gravity<child.value, T>(model, angles, g, unused.data);
    energy = energy - dot(g, part.at + part.h);
  });
  return energy;
}

SKINCTL_END_NAMESPACE
