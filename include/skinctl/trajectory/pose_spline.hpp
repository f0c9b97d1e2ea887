// SPDX-License-Identifier: BSD-3-Clause
// Poses that move: splines from a pose to a goal, in a straight line and by one turn, section 4.2.5.
#pragma once

#include "skinctl/frames/acceleration.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/trajectory/spline_so3.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Reference pose of a frame `P` in the base with velocity and acceleration, along the axes of the base.
template <Frame P, Scalar T = double>
struct PoseReference {
  Transform<Base, P, T> X_BP;
  Twist<P, Base, P, Base, T> V;
  Acceleration<P, Base, P, Base, T> A;

  template <class F>
  friend void each_number(PoseReference& g, F&& f) {
    each_number(g.X_BP, f);
    for (auto* v : {&g.V.linear, &g.V.angular, &g.A.linear, &g.A.angular}) each_number(*v, f);
  }
};

/// A spline of poses from `X_i` to `X_g` in `tf` seconds: the origin in a straight line, the axes by the
/// shortest turn about one axis, both along the quintic, eq. (22). At rest at both ends. Trivially copyable.
template <Frame P, Real T = double>
class PoseSpline {
 public:
  using Pose = Transform<Base, P, T>;

  /// A spline at rest in the base's own pose.
  PoseSpline() noexcept : PoseSpline(Pose(), Pose(), T(0)) {}
  /// @param tf  duration [s]; if not positive, the reference is `X_g` from the start.
  PoseSpline(const Pose& X_i, const Pose& X_g, const T& tf) noexcept
      : p_i_(X_i.origin()), p_g_(X_g.origin()), turn_(X_i.axes(), X_g.axes(), tf), tf_(tf) {}
  [[nodiscard]] const T& duration() const noexcept { return tf_; }  ///< [s]

  /// This spline with a start in motion: it begins with the velocity and acceleration of `now` along its line
  /// and about its turn, as far as `MovingStart` takes them.
  [[nodiscard]] PoseSpline from(const PoseReference<P, T>& now) const noexcept {
    PoseSpline next = *this;
    const Xyz<T> d = p_g_ - p_i_;
    const T square = dot(d, d);
    if (square > T(0))
      next.start_ = MovingStart<T>::along(square, dot(now.V.linear, d), dot(now.A.linear, d), tf_);
    next.turn_ = turn_.from(now.V.angular, now.A.angular);
    return next;
  }

  /// The reference `t` [s] after the start: at rest at exactly `X_i` before it, at `X_g` from the end on.
  [[nodiscard]] PoseReference<P, T> at(const T& t) const noexcept {
    const T rate = tf_ > T(0) ? T(T(1) / tf_) : T(0);
    auto way = quintic(tf_ > T(0) ? T(t / tf_) : T(1), rate);
    if (start_.rate > T(0) && t < tf_) [[unlikely]]
      way = way + start_.at(T(t / tf_), tf_);
    const Xyz<T> d = p_g_ - p_i_;
    const auto r = turn_.at(t);
    const Xyz<T> p = way.a1 <= T(0.5) ? Xyz<T>(p_i_ + way.a1 * d) : Xyz<T>(p_g_ - way.rest * d);
    return {Pose::trusted(r.R, p), {way.a2 * d, r.omega}, {way.a3 * d, r.domega}};
  }
  /// The whole turn as a rotation vector [rad].
  [[nodiscard]] const Xyz<T>& turn() const noexcept { return turn_.turn(); }

 private:
  Xyz<T> p_i_, p_g_;
  RotationSpline<T> turn_;
  T tf_;
  MovingStart<T> start_;
};

SKINCTL_END_NAMESPACE
