// Gravity torques, and the potential energy that they come from.
#pragma once

#include "skinctl/dynamics/detail/recursion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Mass and first moment of mass about a link's origin, in some axes.
template <class Mass, class H>
struct MassMoment {
  Mass mass;
  H h;
};
template <class Mass, class H>
MassMoment(Mass, H) -> MassMoment<Mass, H>;

/// Writes `tau[I]` for the subtree of link `I` under the gravitational acceleration `g_parent` (parent's
/// axes) and returns the subtree's mass and first moment in the parent's frame: only vectors of three travel
/// back.
template <std::size_t I, Scalar T, Model M, class Angles, class G>
SKINCTL_INLINE constexpr auto subtree_gravity(const M& model, const Angles& angles, const G& g_parent,
                                              T* tau) noexcept {
  const auto frame = joint_frame<I>(model, angles);
  const auto g = frame.to_link(g_parent);
  const auto own_mass = model.template number<I, Parameter::mass, T>();
  const auto own_h = own_mass * centre_of_mass<I, T>(model);
  const auto total = [&]() SKINCTL_INLINE_LAMBDA {
    if constexpr (children<M, int(I)>.size() == 0) {
      return MassMoment{own_mass, own_h};
    } else {
      T mass(own_mass);
      auto h = dense<T>(own_h);
      for_each_link<children<M, int(I)>>([&](auto child) SKINCTL_INLINE_LAMBDA {
        const auto part = subtree_gravity<child.value, T>(model, angles, g, tau);
        mass = mass + part.mass;
        h = dense<T>(h + part.h);
      });
      return MassMoment<T, Xyz<T>>{mass, h};
    }
  }();
  if constexpr (M::kinds[I] == JointKind::revolute) {
    tau[I] = T(-(total.h.x * g.y - total.h.y * g.x));
  } else {
    tau[I] = T(-(total.mass * g.z));
  }
  return MassMoment{total.mass, frame.to_parent(total.h) + total.mass * frame.p};
}

}  // namespace detail

/// `G(q)` [N m], the torques that hold the robot against gravity: `G = dV/dq` of the potential energy.
template <Model M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque(
    const M& model, const JointAngles<M, T, Mask>& angles) noexcept {
  JointTorque<M::joints, T> tau;
  const auto g = model.template gravity<T>();
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    static_cast<void>(detail::subtree_gravity<child.value, T>(model, angles, g, tau.data));
  });
  return tau;
}
template <Model M, Scalar T>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque(
    const M& model, const JointPosition<M::joints, T>& q) noexcept {
  return gravity_torque(model, JointAngles<M, T>(model, q));
}

/// Potential energy `V(q) = -g . sum m_i r_i` [J], zero with all mass at the base's origin.
template <Model M, Scalar T>
[[nodiscard]] SKINCTL_INLINE T potential_energy(const M& model,
                                                const JointPosition<M::joints, T>& q) noexcept {
  JointTorque<M::joints, T> unused;
  const JointAngles<M, T> angles(model, q);
  const auto g = model.template gravity<T>();
  T energy(0);
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    const auto part = detail::subtree_gravity<child.value, T>(model, angles, g, unused.data);
    energy = energy - dot(g, part.h);
  });
  return energy;
}

SKINCTL_END_NAMESPACE
