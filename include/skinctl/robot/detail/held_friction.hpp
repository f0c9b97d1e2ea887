// SPDX-License-Identifier: BSD-3-Clause
// Friction by a torque that answers a measured speed late.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Viscous friction `B dq` of the joints of `S` by a torque that acts `delay` seconds after the speed was
/// measured, in the mean: D, see `RobotDescription::loop_delay`. Friction that would stop a motion in less
/// time would shake it: the friction applied is `(B^-1 + D M^-1)^-1 dq`, which is at most `M dq / D` in every
/// direction, and B dq where the masses are large. The light links of a finger are coupled: divided joint by
/// joint by `1 + D B/M_ii` it would shake them.
///
/// @param b     viscous friction B of all joints [N m s/rad]; joints that are not in `S` are left out.
/// @param mass  mass matrix of all joints; the result is zero where it could not be factorised.
template <class S, std::size_t N, Real T>
[[nodiscard]] SKINCTL_NOINLINE JointTorque<S::count, T> held_friction(const JointTorque<N, T>& b,
                                                                      const MassMatrix<N, T>& mass,
                                                                      const JointVelocity<N, T>& dq,
                                                                      const T& delay) noexcept {
  constexpr std::size_t n = S::count;
  JointTorque<n, T> drag;
  MassMatrix<n, T> slowed = block_of<S>(mass);
  const auto p = momentum_of<S>(mass, dq);  // (M + D B) v = M dq, the drag is B v
  for (std::size_t i = 0; i < n; ++i) slowed(i, i) += delay * b[S::index[i]];
  const math::Ldlt<n, T> factors(slowed.data);
  if (!factors.positive_definite()) return drag;
  T after[n];
  factors.solve(p.data, after);
  for (std::size_t i = 0; i < n; ++i) drag[i] = b[S::index[i]] * after[i];
  return drag;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
