// SPDX-License-Identifier: BSD-3-Clause
// Friction, braking and holding by a torque that answers a measurement late.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/robot_configuration.hpp"
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

/// Time in which a robot that is stopped only brakes, over D: a hundredth of its speed is left.
inline constexpr double brake_delays = 15;
/// Largest torque that holds a stopped joint, over its limit: at the tool of an FR3 some 25 N, less than a
/// hand gives and than ISO/TS 15066 allows on most of a body, more than a gripper weighs.
inline constexpr double hold_share = 0.2;

/// The torque that holds the stopped joints of `S`, at `q`, where they stood [N m]: `(c/2)^2 M (stood - q)`
/// with `c = gain_times_delay / D`, a spring that the braking `c M dq` damps critically. Where it would be
/// more than `hold_share` of a limit, `stood` is moved towards the robot, as by dry friction: who is held down
/// can free himself.
/// @param mass    mass matrix of all joints.
/// @param limits  largest torques of all joints [N m].
/// @param delay   D, as of `held_friction` [s].
/// @param m       `stopped`, the time since the stop began [s], and `stood` [rad], which is where the joints
///                are until they have braked.
template <class S, std::size_t N, Real T, class Memory>
[[nodiscard]] SKINCTL_COLD JointTorque<S::count, T> held_in_place(const MassMatrix<N, T>& mass,
                                                                  const JointTorque<N, T>& limits,
                                                                  const JointPosition<N, T>& q,
                                                                  const T& delay, Memory& m) noexcept {
  auto& stood = m.stood;
  if (m.stopped < T(brake_delays) * delay) stood = S::of(q);
  const T rate = T(gain_times_delay / 2) / delay;
  JointVelocity<N, T> back;
  for (std::size_t i = 0; i < S::count; ++i) back[S::index[i]] = rate * (stood[i] - q[S::index[i]]);
  JointTorque<S::count, T> held = momentum_of<S>(mass, back);
  T share(1);
  for (std::size_t i = 0; i < S::count; ++i) {
    held[i] *= rate;
    const T most = T(hold_share) * limits[S::index[i]], size = held[i] < T(0) ? -held[i] : held[i];
    if (share * size > most) share = most / size;
  }
  for (std::size_t i = 0; i < S::count; ++i) {
    held[i] *= share;
    if (share < T(1)) stood[i] = q[S::index[i]] + share * (stood[i] - q[S::index[i]]);
  }
  return held;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
