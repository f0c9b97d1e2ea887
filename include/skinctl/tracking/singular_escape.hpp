// SPDX-License-Identifier: BSD-3-Clause
// Motion out of a singularity towards a goal for which the damped inverse gives none.
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/kinematics/singular_directions.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A motion of the joints that does not move the frame at first: the arm turns round (a wrist by up to a
/// right angle) until the commanded direction is no longer singular. A state of tracking laws, two
/// first-order lags behind `wish`, so that neither its velocity nor its acceleration has steps.
template <std::size_t N, Real T = double>
struct SingularEscape {
  JointVelocity<N, T> v;      ///< joint velocity of the escape [rad/s]
  JointAcceleration<N, T> a;  ///< derivative of `v` [rad/s^2]

  static constexpr double zone = detail::singular_zone;
  static constexpr double lag = detail::singular_lag;  ///< time constant of either filter [s]
  /// Largest speed of a joint in an escape, over its limit: the rest is for what the frame follows meanwhile.
  static constexpr double share = 0.97;
  /// Commanded speed [m/s, rad/s] for 0.7 of the escape's pace: slower ones are the end of an error.
  static constexpr double min_speed = 0.004;

  /// The state `dt` seconds later, by backward Euler: stable for every dt. A wish that is not finite changes
  /// nothing.
  [[nodiscard]] SingularEscape advanced(const JointVelocity<N, T>& wish, const T& dt) const noexcept {
    using R = detail::Row<N, T>;
    const T w = T(1) / T(lag), scale = T(1) / (T(1) + w * dt * (T(2) + w * dt));
    const R rate = scale * (R(a) + T(w * w * dt) * (R(wish) - v));
    const auto finite = rate - rate == R(T(0));
    return {JointVelocity<N, T>(select(finite, R(v) + dt * rate, R(v))),
            JointAcceleration<N, T>(select(finite, rate, R(a)))};
  }

  /// The joint velocity that the escape goes over to, where `asked` is the frame's commanded velocity: along
  /// the right singular vectors v of those singular directions in which `asked` has a component, as fast as
  /// `share` of `limit` allows if nothing else moves; slower by the part of `asked` that the frame can
  /// already follow. Zero where `asked` leads out of the workspace. On a path that is nearly straight
  /// rounding decides the sign of sigma, and with it that of v: there the present sense of rotation is kept,
  /// so that it does not alternate.
  template <TaskSpace What, class J, class Velocity>
  [[nodiscard]] SKINCTL_COLD JointVelocity<N, T> wish(const J& jacobian, const Velocity& asked,
                                                      const JointVelocity<N, T>& limit) const noexcept {
    using std::sqrt;
    const auto at = singular_directions<What>(jacobian);
    T c[2], left = along(asked, asked), size(0), moved(0), most(0);
    for (std::size_t n = 0; n < 2; ++n) {
      c[n] = nearness(at[n].sigma, T(zone)) * along(at[n].u, asked);
      left = left - c[n] * c[n];
    }
    leave_closed_ways(jacobian, at, c);
    JointVelocity<N, T> turn;
    for (std::size_t n = 0; n < 2; ++n) {
      size = size + c[n] * c[n];
      moved = moved + at[n].sigma * at[n].sigma * c[n] * c[n];
      turn += c[n] * at[n].v;
    }
    T onward(0), bend(0), slowest = limit[0];
    for (std::size_t i = 0; i < N; ++i) {
      if (limit[i] < slowest) slowest = limit[i];
      if (detail::magnitude(turn[i]) > most * limit[i]) most = detail::magnitude(turn[i]) / limit[i];
      onward = onward + turn[i] * v[i];
    }
    if (!(most > T(0)) || !(size > T(0))) return {};
    if (onward < T(0) && moved < T(bent * bent) * size) {
      const auto acceleration = bias_acceleration(jacobian, turn);
      for (std::size_t n = 0; n < 2; ++n) bend = bend + c[n] * along(at[n].u, acceleration);
      if (detail::magnitude(bend) < T(2 * bent) * size * sqrt(size)) most = -most;
    }
    const T other = left / (left + size), straight = slowest * slowest * moved / size;
    const T pace =
        sqrt(size / (size + straight + T(min_speed) * T(min_speed))) * (T(1) - other * other * other);
    return T(T(share) * pace / most) * turn;
  }

 private:
  template <class P, class Q>
  static T along(const P& p, const Q& q) noexcept {
    return dot(p.linear, q.linear) + dot(p.angular, q.angular);
  }
  static T nearness(const T& sigma, const T& edge) noexcept {
    const T left = T(1) - sigma * sigma / (edge * edge);
    return left > T(0) ? T(left * left) : T(0);
  }
  /// Removes from the commanded velocity `c` its part along a closed path.
  /// A motion x of the joints bends the frame's path towards `q = u' dJ(x) x`: where q points away from the
  /// commanded velocity c, the workspace ends, at `sigma / |q|` radians along x. The two such x are the
  /// eigenvectors of `c' u' dJ(x) x`; the part of c along a closed one is removed, and the remainder left to
  /// the other.
  template <class J, class D>
  static void leave_closed_ways(const J& jacobian, const D& at, T (&c)[2]) noexcept {
    using std::sqrt;
    const T meet = nearness(at[1].sigma, T(zone) / T(second_zone));
    const T part[2] = {T(1), meet};
    const auto bend = [&](const JointVelocity<N, T>& x, T(&q)[2]) {
      const auto acceleration = bias_acceleration(jacobian, x);
      for (std::size_t n = 0; n < 2; ++n) q[n] = part[n] * along(at[n].u, acceleration);
    };
    const auto towards = [&](const T(&q)[2]) { return T(c[0] * q[0] + c[1] * q[1]); };
    const JointVelocity<N, T> y = sqrt(meet) * at[1].v;
    T qx[2], qy[2], qxy[2];
    bend(at[0].v, qx), bend(y, qy), bend(at[0].v + y, qxy);
    for (std::size_t n = 0; n < 2; ++n) qxy[n] = T(0.5) * (qxy[n] - qx[n] - qy[n]);
    const T half = T(0.5) * (towards(qx) - towards(qy)), mixed = towards(qxy);
    const T whole = sqrt(half * half + mixed * mixed);
    // The eigenvector of the smaller eigenvalue, and the other at right angles to it.
    T e[2] = {half < T(0) ? T(whole - half) : T(-mixed), half < T(0) ? T(-mixed) : T(whole + half)};
    const T size = sqrt(e[0] * e[0] + e[1] * e[1]);
    if (size > T(0))
      e[0] = e[0] / size, e[1] = e[1] / size;
    else
      e[0] = towards(qx) < T(0) ? T(1) : T(0), e[1] = T(1) - e[0];
    T rest[2] = {c[0], c[1]}, closed[2];
    for (std::size_t k = 0; k < 2; ++k) {
      const T x = k == 0 ? e[0] : T(-e[1]), z = k == 0 ? e[1] : e[0];
      T q[2];
      for (std::size_t n = 0; n < 2; ++n) q[n] = x * x * qx[n] + T(2) * x * z * qxy[n] + z * z * qy[n];
      const T square = q[0] * q[0] + q[1] * q[1], length = sqrt(square), against = towards(q);
      const T sigma = sqrt(x * x * at[0].sigma * at[0].sigma + z * z * at[1].sigma * at[1].sigma);
      const T fold = (length - sigma / T(ahead)) / T(bent) - T(0.5);
      closed[k] = against < T(0) && fold > T(0) ? (fold < T(1) ? fold : T(1)) : T(0);
      if (closed[k] > T(0) && k == 0)
        for (std::size_t n = 0; n < 2; ++n) rest[n] = rest[n] - against / square * q[n];
    }
    const T f[2] = {T(-e[1]), e[0]};
    const T amount = (T(1) - closed[1]) * sqrt(rest[0] * rest[0] + rest[1] * rest[1]);
    const bool back = rest[0] * at[0].sigma * f[0] + rest[1] * at[1].sigma * f[1] < T(0);
    for (std::size_t n = 0; n < 2; ++n) c[n] = c[n] + closed[0] * ((back ? -amount : amount) * f[n] - c[n]);
  }
  /// Curvature |q| of the frame's path [m/rad^2] below which it counts as straight: a link of 1 m has 1.
  static constexpr double bent = 0.0002;
  /// Angle [rad]: a path on which sigma vanishes within it is closed; what dJ tells does not reach further.
  static constexpr double ahead = 0.2;
  /// Width of the singular zone over that for the second smallest singular value: outside of that narrower
  /// zone the second direction counts as regular.
  static constexpr int second_zone = 3;
};

SKINCTL_END_NAMESPACE
