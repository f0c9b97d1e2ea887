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

/// Joints whose angle G does not depend on, as their model's types tell: the first of a chain if it turns
/// about the vertical, and the last of a branch if its link's centre of mass lies on the axis.
template <Model M, Scalar T>
constexpr LinkMask weightless_angles() noexcept {
  using P = Parameter;
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

/// Writes G from sines and cosines that may lack those of the angles above.
template <Scalar T, Model M, class Angles>
SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque_from(const M& model, const Angles& angles) noexcept {
  JointTorque<M::joints, T> tau;
  const auto g = model.template gravity<T>();
  for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    static_cast<void>(subtree_gravity<child.value, T>(model, angles, g, tau.data));
  });
  return tau;
}

}  // namespace detail

/// `G(q)` [N m], the torques that hold the robot against gravity: `G = dV/dq` of the potential energy.
template <Model M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque(
    const M& model, const JointAngles<M, T, Mask>& angles) noexcept {
  return detail::gravity_torque_from<T>(model, angles);
}
template <Model M, Scalar T>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> gravity_torque(
    const M& model, const JointPosition<M::joints, T>& q) noexcept {
  constexpr LinkMask all = all_links(M::joints);
  return detail::gravity_torque_from<T>(model,
                                        JointAngles<M, T, all, detail::weightless_angles<M, T>()>(model, q));
}
// clang-format off
template <Model M, Scalar T> requires(!computes_in<M, T>)
void gravity_torque(const M&, const JointPosition<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
// clang-format on

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
