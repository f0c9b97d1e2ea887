// Splines in joint space: from the robot's position to a goal, at rest at both ends, eq. (22).
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/trajectory/quintic.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Reference position of a robot with velocity and acceleration.
template <std::size_t N, Scalar T = double>
struct JointReference {
  JointPosition<N, T> q_d;
  JointVelocity<N, T> dq_d;
  JointAcceleration<N, T> ddq_d;
};

/// `q_d = q_i + a1 (q_g - q_i)` and its derivatives, over `tf` seconds. Trivially copyable.
template <std::size_t N, Real T = double>
struct JointSpline {
  JointPosition<N, T> q_i;
  JointPosition<N, T> q_g;
  T tf = T(0);  ///< [s]; if not positive, the reference is the goal from the start

  /// The reference `t` seconds after the start: at rest in `q_i` before it, at rest in `q_g` (exactly) from
  /// the end on.
  [[nodiscard]] SKINCTL_INLINE JointReference<N, T> at(const T& t) const noexcept {
    const T rate = tf > T(0) ? T(T(1) / tf) : T(0);
    const auto way = quintic(tf > T(0) ? T(t / tf) : T(1), rate);
    // From the nearer end, so that both ends are met exactly.
    const bool early = way.a1 <= T(0.5);
    const detail::Row<N, T> start = q_i, goal = q_g, d = goal - start;
    return {JointPosition<N, T>((early ? start : goal) + (early ? way.a1 : T(-way.rest)) * d),
            JointVelocity<N, T>(way.a2 * d), JointAcceleration<N, T>(way.a3 * d)};
  }
};

/// The shortest time [s] for which a spline of length `distance` keeps below `dq_max`:
/// `1.875 |distance| / dq_max`.
template <Real T>
[[nodiscard]] constexpr T shortest_spline_time(const T& distance, const T& dq_max) noexcept {
  const T size = distance < T(0) ? T(-distance) : distance;
  return quintic_peak_speed<T> * size / dq_max;
}

SKINCTL_END_NAMESPACE
