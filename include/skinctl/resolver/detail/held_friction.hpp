// Friction by a torque that is held for a period.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/passivity/contact_damper.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Viscous friction `B dq` of the joints of `S` by a torque that is held for `period` seconds. Friction that would
/// stop a motion in less time would shake it: the friction applied is `(B^-1 + 3/2 h M^-1)^-1 dq`, which is
/// at most `2/(3 h) M dq` in every direction, and B dq where the masses are large. The light links of a finger are
/// coupled: divided joint by joint by `1 + 3/2 h B/M_ii` it would shake them.
///
/// @param b     of all joints; those that are not in `S` are left out.
/// @param mass  of all joints. Zero where it could not be factorised.
template <class S, std::size_t N, Real T>
[[nodiscard]] SKINCTL_NOINLINE JointTorque<S::count, T> held_friction(const JointTorque<N, T>& b,
                                                                      const MassMatrix<N, T>& mass,
                                                                      const JointVelocity<N, T>& dq,
                                                                      const T& period) noexcept {
  constexpr std::size_t n = S::count;
  JointTorque<n, T> drag;
  MassMatrix<n, T> slowed = block_of<S>(mass);
  const auto p = momentum_of<S>(mass, dq);  // (M + 3/2 h B) v = M dq, the drag is B v
  for (std::size_t i = 0; i < n; ++i) slowed(i, i) += T(1.5) * period * b[S::index[i]];
  const math::Ldlt<n, T> factors(slowed.data);
  if (!factors.positive_definite()) return drag;
  T after[n];
  factors.solve(p.data, after);
  for (std::size_t i = 0; i < n; ++i) drag[i] = b[S::index[i]] * after[i];
  return drag;
}

/// The torque of the joints of `S` against the damping of contacts, held for `period` seconds: each
/// coefficient divided by `1 + 3/2 h sum_k b_k w_k`, w_k the mobility of contact k, so that all of them
/// together cannot reverse a motion. Zero where the mass matrix could not be factorised.
///
/// @param mass  of all joints; those that are not in `S` are taken to move as they do.
template <class S, std::size_t N, Real T>
[[nodiscard]] SKINCTL_NOINLINE JointTorque<S::count, T> held_damping(const ContactDamping<N, T>& damping,
                                                                     const MassMatrix<N, T>& mass,
                                                                     const JointVelocity<N, T>& dq,
                                                                     const T& period) noexcept {
  JointTorque<S::count, T> drag;
  const math::Ldlt<S::count, T> factors(block_of<S>(mass).data);
  if (!factors.positive_definite()) return drag;
  T fastest(0);
  for (std::size_t k = 0; k < damping.count; ++k) {
    JointTorque<S::count, T> row;
    JointAcceleration<S::count, T> given;
    for (std::size_t i = 0; i < S::count; ++i) row[i] = damping.row[k][S::index[i]];
    factors.solve(row.data, given.data);
    for (std::size_t i = 0; i < S::count; ++i) fastest = fastest + damping.coefficient[k] * row[i] * given[i];
  }
  const T share = T(1) / (T(1) + T(1.5) * period * fastest);
  for (std::size_t k = 0; k < damping.count; ++k) {
    T speed(0);
    for (std::size_t i = 0; i < N; ++i) speed = speed + damping.row[k][i] * dq[i];
    for (std::size_t i = 0; i < S::count; ++i)
      drag[i] = drag[i] + share * damping.coefficient[k] * speed * damping.row[k][S::index[i]];
  }
  return drag;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
