// Friction by a torque that is held for a period.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/passivity/contact_damper.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `B dq` for a joint of friction `b` and inertia `own` whose torque is held for `period` seconds. Friction
/// that would stop the joint in less time would shake it: the friction applied is `B / (1 + 3/2 h B/M_ii)`.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T held_friction(const T& b, const T& own, const T& period,
                                             const T& dq) noexcept {
  return own > T(0) ? T(b * own / (own + T(1.5) * period * b) * dq) : T(0);
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
