// The recursion of inverse dynamics over the links of a model: straight-line code, or link by link.
#pragma once

#include "skinctl/dynamics/detail/link_by_link.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <std::size_t N, class T>
inline constexpr T joints_at_rest[N] = {};
/// Joints as an array, those of `NoValues` zeros.
template <class T>
SKINCTL_INLINE constexpr const T* joints_of(const Values<T>& v, const T*) noexcept {
  return v.data;
}
template <class T>
SKINCTL_INLINE constexpr const T* joints_of(const NoValues&, const T* zeros) noexcept {
  return zeros;
}

/// `run_recursion_over` the links of the model itself.
template <Scalar T, RobotModel M, class Angles, class V, class R, class A, class L>
SKINCTL_INLINE constexpr void run_recursion(const M& model, const Angles& angles, const V& dq, const R& dq_r,
                                            const A& ddq_r, const L& a0, T* tau) noexcept {
  if constexpr (goes_link_by_link<M, T>) {
    const auto& zeros = joints_at_rest<M::joints, T>;
    recursion_in_loop<M>(angles.sin, angles.cos, joints_of(dq, zeros), joints_of(dq_r, zeros),
                         joints_of(ddq_r, zeros), dense<T>(a0), tau);
  } else {
    run_recursion_over<T>(model, ModelBodies<M>{model}, angles, dq, dq_r, ddq_r, a0, tau);
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
