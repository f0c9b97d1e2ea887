// SPDX-License-Identifier: BSD-3-Clause
// Splines in joint space: from the robot's position to a goal, at rest at both ends, eq. (22).
#pragma once

#include <cmath>

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

  template <class F>
  friend void each_number(JointReference& g, F&& f) {
    each_number(g.q_d, f), each_number(g.dq_d, f), each_number(g.ddq_d, f);
  }
};

/// A spline of the joints, `q_d = q_i + a1 (q_g - q_i)` and its derivatives, over `tf` seconds; a1 is the
/// quintic of the paper's eq. (22). Trivially copyable.
template <std::size_t N, Real T = double>
struct JointSpline {
  JointPosition<N, T> q_i;
  JointPosition<N, T> q_g;
  T tf = T(0);  ///< duration [s]; if not positive, `q_d` is `q_g` from the start
  [[nodiscard]] const T& duration() const noexcept { return tf; }
  JointVelocity<N, T> rate = {};      ///< initial rate of the covered part, see `MovingStart` [1/s]
  JointAcceleration<N, T> bend = {};  ///< derivative of `rate` [1/s^2]
  bool moves = false;                 ///< whether a `rate` is not zero

  /// This spline with a start in motion: the velocity and acceleration of `now`, see `MovingStart`.
  [[nodiscard]] constexpr JointSpline from(const JointReference<N, T>& now) const noexcept {
    JointSpline next = *this;
    for (std::size_t i = 0; i < N; ++i) {
      const auto start = MovingStart<T>::along(T(q_g[i] - q_i[i]), now.dq_d[i], now.ddq_d[i], tf);
      next.rate[i] = start.rate;
      next.bend[i] = start.bend;
      next.moves = next.moves || start.rate > T(0);
    }
    return next;
  }

  /// The reference `t` seconds after the start: at rest in `q_i` before it, at rest in `q_g` (exactly) from
  /// the end on.
  [[nodiscard]] SKINCTL_INLINE JointReference<N, T> at(const T& t) const noexcept {
    const auto way = quintic(tf > T(0) ? T(t / tf) : T(1), tf > T(0) ? T(T(1) / tf) : T(0));
    // From the nearer end, so that both ends are met exactly.
    const bool early = way.a1 <= T(0.5);
    const detail::Row<N, T> start = q_i, goal = q_g, d = goal - start;
    JointReference<N, T> out{
        JointPosition<N, T>((early ? start : goal) + (early ? way.a1 : T(-way.rest)) * d),
        JointVelocity<N, T>(way.a2 * d), JointAcceleration<N, T>(way.a3 * d)};
    if (moves && t < tf) [[unlikely]]
      add_start(t, out);
    return out;
  }
  SKINCTL_COLD void add_start(const T& t, JointReference<N, T>& out) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const auto more = MovingStart<T>{rate[i], bend[i]}.at(T(t / tf), tf);
      const T d = q_g[i] - q_i[i];
      out.q_d[i] = out.q_d[i] + more.a1 * d;
      out.dq_d[i] = out.dq_d[i] + more.a2 * d;
      out.ddq_d[i] = out.ddq_d[i] + more.a3 * d;
    }
  }
};

/// The shortest time [s] for which a spline of length `distance` keeps below `dq_max`:
/// `1.875 |distance| / dq_max`.
template <Real T>
[[nodiscard]] constexpr T shortest_spline_time(const T& distance, const T& dq_max) noexcept {
  const T size = distance < T(0) ? T(-distance) : distance;
  return quintic_peak_speed<T> * size / dq_max;
}
/// The shortest time [s] for which it also keeps below the acceleration `ddq_max`: at least
/// `sqrt(10/sqrt(3) |distance| / ddq_max)`.
template <Real T>
[[nodiscard]] T shortest_spline_time(const T& distance, const T& dq_max, const T& ddq_max) noexcept {
  using std::sqrt;
  const T size = distance < T(0) ? T(-distance) : distance, time = shortest_spline_time(distance, dq_max);
  const T least = sqrt(quintic_peak_acceleration<T> * size / ddq_max);
  return time < least ? least : time;
}

SKINCTL_END_NAMESPACE
