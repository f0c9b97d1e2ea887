// SPDX-License-Identifier: BSD-3-Clause
// Rest at a goal next to a singularity.
#pragma once

#include "skinctl/kinematics/singular_directions.hpp"
#include "skinctl/tracking/detail/thresholds.hpp"
#include "skinctl/trajectory/quintic.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Next to a singularity the smallest error of the frame asks for large motions of the joints: to get rid of
/// a micrometre a wrist would turn for ever. So where a goal stands still and is reached, the joint motions
/// along singular directions leave the error as it is and hold the position that they have: `dq_r <- dq_r - r
/// P (dq_r + K (q - q_rest))`, P the projection onto them. A state of tracking laws.
template <std::size_t N, Real T = double>
struct SingularRest {
  JointPosition<N, T> q;  ///< position that is held [rad]
  T r = T(0);             ///< weight of the rest, 0 to 1, a first-order lag behind `on`
  bool on = false;

  static constexpr double zone = detail::singular_zone;
  static constexpr double lag = detail::singular_lag;  ///< time constant of `r` [s]
  /// Share of the tolerances within which a rest begins; it ends beyond the whole tolerances.
  static constexpr double inner_share = 0.5;
  /// Range of the nearness to a singularity over which the rest fades in, from the damping's edge.
  static constexpr double fade_nearness = 0.25;
  /// Weight below which a rest is over: a decay by itself never is.
  static constexpr double min_weight = 1e-6;

  /// Whether the goal is reached: within half the tolerances, then until it is out of them.
  /// @param distance_squared  sum of the squared errors of the frame, each over its tolerance.
  /// @param speed_squared     sum of the squares of the goal's velocity and of the bias S_d, with which the
  ///                          robot moved when the goal came [m^2/s^2 + rad^2/s^2].
  [[nodiscard]] bool reached(const T& distance_squared, const T& speed_squared) const noexcept {
    return distance_squared + speed_squared / T(detail::standing_speed * detail::standing_speed) <
           (on ? T(1) : T(inner_share * inner_share));
  }
  /// The state `dt` [s] later: `on` if the goal is `reached`, with `q` the joint positions `now` at which
  /// that began, and `r` behind it.
  [[nodiscard]] SKINCTL_INLINE SingularRest advanced(bool reached, const JointPosition<N, T>& now,
                                                     const T& dt) const noexcept {
    if (!reached && !(r > T(0))) [[likely]]
      return *this;
    SingularRest next = *this;
    if (reached && !on) next.q = now;
    next.on = reached;
    next.r = r + dt / (T(lag) + dt) * (T(reached ? 1 : 0) - r);
    if (!reached && next.r < T(min_weight)) next.r = T(0);
    return next;
  }

  /// The singular directions of `jacobian`, weighted from 0, at the edges of zone and damping, to 1.
  template <TaskSpace What, class J>
  class Directions {
   public:
    /// @param nearness  of the singularity, 0 to 1: see `DampedInverse::nearness`.
    Directions(const J& jacobian, const T& nearness) noexcept : at_(singular_directions<What>(jacobian)) {
      const T fade = nearness < T(fade_nearness) ? T(T(1 / fade_nearness) * nearness) : T(1);
      for (std::size_t n = 0; n < 2; ++n) {
        const T left = T(1) - at_[n].sigma * at_[n].sigma / T(zone * zone);
        share_[n] = left > T(0) ? T(fade * left * left) : T(0);
      }
    }
    /// The part of the rate of an integral along the singular directions, whole already where they have a
    /// little weight: an integral of an error that is left as it is would creep.
    template <class V>
    [[nodiscard]] V of_frame(const V& v) const noexcept {
      V part{};
      for (std::size_t n = 0; n < 2; ++n) {
        const T c = quintic(T(T(1 / full_weight) * share_[n])).a1 *
                    (dot(at_[n].u.linear, v.linear) + dot(at_[n].u.angular, v.angular));
        part.linear = part.linear + c * at_[n].u.linear;
        part.angular = part.angular + c * at_[n].u.angular;
      }
      return part;
    }
    /// `P x`: the part of a joint motion along the singular directions.
    template <class X>
    [[nodiscard]] X of_joints(const X& x) const noexcept {
      X part;
      for (std::size_t n = 0; n < 2; ++n) {
        T c(0);
        for (std::size_t i = 0; i < N; ++i) c = c + at_[n].v[i] * x[i];
        for (std::size_t i = 0; i < N; ++i) part[i] = part[i] + share_[n] * c * at_[n].v[i];
      }
      return part;
    }

   private:
    /// Weight from which on all of a direction's integral stands.
    static constexpr double full_weight = 0.125;

    decltype(singular_directions<What>(std::declval<const J&>())) at_;
    T share_[2];
  };

  /// Adds the rest to the reference motion of joints at `now` that move at `dq`, with the gain K [1/s]. The
  /// derivative leaves out that P turns with the joints: at rest it does not.
  template <class D>
  void hold(const D& directions, const JointPosition<N, T>& now, const JointVelocity<N, T>& dq, const T& K,
            JointVelocity<N, T>& dq_r, JointAcceleration<N, T>& ddq_r) const noexcept {
    const T dr = (T(on ? 1 : 0) - r) / T(lag);
    JointVelocity<N, T> x;
    JointAcceleration<N, T> a;
    for (std::size_t i = 0; i < N; ++i) {
      x[i] = dq_r[i] + K * (now[i] - q[i]);
      a[i] = r * (ddq_r[i] + K * dq[i]) + dr * x[i];
    }
    dq_r -= r * directions.of_joints(x);
    ddq_r -= directions.of_joints(a);
  }
};

SKINCTL_END_NAMESPACE
