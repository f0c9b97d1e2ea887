// SPDX-License-Identifier: BSD-3-Clause
// Goals and targets of laws in operational space: poses of a tool, and the paths between them.
#pragma once

#include <limits>

#include "skinctl/kinematics/damped_inverse.hpp"
#include "skinctl/tracking/orientation_error.hpp"
#include "skinctl/tracking/redundancy.hpp"
#include "skinctl/tracking/sliding_surface.hpp"
#include "skinctl/trajectory/plan_clock.hpp"
#include "skinctl/trajectory/pursuit.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of a tracking law in operational space.
template <std::size_t N, Real T = double>
struct OperationalSettings {
  /// Gains and times, as in joint space, of coordinates in metres and radians. `max_velocity` is the largest
  /// reference speed of any joint, next to a singularity too.
  JointControlSettings<N, T> tracking = {};
  // Accelerations reach these speeds in 0.3 s, jerks the accelerations in 0.1 s: the pace of a hand.
  T max_linear_velocity = T(0.5);      ///< largest linear velocity of any motion to a goal [m/s]
  T max_angular_velocity = T(1.5);     ///< largest angular velocity of any motion to a goal [rad/s]
  T max_linear_acceleration = T(1.5);  ///< largest linear acceleration after a reactive target [m/s^2]
  T max_linear_jerk = T(15);           ///< largest linear jerk after a reactive target [m/s^3]
  T max_angular_acceleration = T(5);   ///< largest angular acceleration after a reactive target [rad/s^2]
  T max_angular_jerk = T(50);          ///< largest angular jerk after a reactive target [rad/s^3]
  /// Zone in which the inverse Jacobian is damped, and the largest damping; the joints' speed determines how
  /// much of it is used.
  SingularityDamping<T> singularities = SingularityDamping<T>(T(0.01), T(0.08));
  T min_damping = T(0.02);  ///< damping of the inverse at a singularity for a reference nearly at rest
  /// Next to a singularity a goal that stands still counts as reached within these, and nothing moves.
  T reached_position = T(2e-4);     ///< tolerance of the position [m]
  T reached_orientation = T(1e-3);  ///< tolerance of the orientation [rad]
};

/// Throws `ConfigurationError` for a speed, acceleration, jerk or tolerance of poses out of its range.
template <std::size_t N, Real T>
SKINCTL_COLD void check(const OperationalSettings<N, T>& s) {
  const auto positive = [](const char* what, const T& x) {
    require(x > T(0) && x <= T(1e6), what, static_cast<double>(x), "> 0");
  };
  positive("max_linear_velocity", s.max_linear_velocity);
  positive("max_angular_velocity", s.max_angular_velocity);
  positive("reached_position", s.reached_position);
  positive("reached_orientation", s.reached_orientation);
  check(PursuitLimits<T>{T(1), s.max_linear_acceleration, s.max_linear_jerk});
  check(PursuitLimits<T>{T(1), s.max_angular_acceleration, s.max_angular_jerk});
}

/// Settings of an operational law for this robot: its gains by `tracking_settings`, the limits of the frame
/// at their defaults.
///
/// @param lighter  nothing, a mass ratio, or the description of the lightest robot.
template <class Robot, class... Lighter>
[[nodiscard]] OperationalSettings<Robot::joints, typename Robot::scalar> operational_settings(
    const Robot& robot, const Lighter&... lighter) {
  return {.tracking = tracking_settings(robot, lighter...)};
}

namespace detail {
/// Largest `rotation_error` of a goal's axes that is accepted: a person or a file gives three digits.
inline constexpr double worst_goal_axes = 2e-3;
}  // namespace detail

/// A goal pose of a frame and the time to reach it. Refused if its axes are no rotation to three digits.
template <Frame P, Scalar T = double>
struct PoseGoal {
  Transform<Base, P, T> X_BP;
  Nanoseconds duration{};  ///< time from reception to arrival; 0: the shortest within the speeds

  template <class F>
  friend void each_number(PoseGoal& g, F&& f) {
    each_number(g.X_BP, f), each_number(g.duration, f);
  }
};

/// The members of operational space that plans (`SplinePlan`, `TargetPlan`, `ReactivePlan`) use: poses of `P`
/// on their way to a goal or after a target, their limits and distances.
template <std::size_t N, Frame P, Real T, TaskSpace What>
class PoseTargets {
 public:
  static constexpr std::size_t coordinates = What == TaskSpace::pose ? 6 : 3;
  using Settings = OperationalSettings<N, T>;
  template <class Robot>
  [[nodiscard]] static Settings settings_of(const Robot& robot) {
    return operational_settings(robot);
  }
  using Reference = PoseReference<P, T>;
  using Errors = SurfaceErrors<coordinates, T>;
  using Where = Transform<Base, P, T>;
  using Goal = PoseGoal<P, T>;
  using Spline = PoseSpline<P, T>;

  [[nodiscard]] static SKINCTL_INLINE const Where& where_of(const Reference& r) noexcept { return r.X_BP; }
  [[nodiscard]] static SKINCTL_INLINE const Where& place(const Goal& goal) noexcept { return goal.X_BP; }
  [[nodiscard]] static SKINCTL_INLINE const Where& place(const Reference& r) noexcept { return r.X_BP; }
  /// The motion of the frame, as a reference without acceleration.
  template <class Site>
  [[nodiscard]] static Reference motion(const Site& at) noexcept {
    return {at.X_BP, at.V, {}};
  }
  [[nodiscard]] static Spline spline(const Where& from, const Where& to, const T& tf) noexcept {
    return {from, to, tf};
  }
  [[nodiscard]] static bool stands(const Reference& r) noexcept {
    return dot(r.V.linear, r.V.linear) == T(0) && dot(r.V.angular, r.V.angular) == T(0);
  }
  /// Shortest time from `from` to `goal` within the largest velocities [s]; NaN or infinite if the goal is
  /// not finite, or its axes are no rotation.
  [[nodiscard]] static T shortest_time(const Where& from, const Goal& goal, const Settings& s) noexcept {
    if (!(rotation_error(goal.X_BP.axes()) <= T(detail::worst_goal_axes)))
      return std::numeric_limits<T>::quiet_NaN();
    const T way = norm(Xyz<T>(goal.X_BP.origin() - from.origin()));
    const T turn = What == TaskSpace::pose ? norm(log_so3(goal.X_BP.axes() * from.axes().transpose())) : T(0);
    const T a = shortest_spline_time(way, s.max_linear_velocity);
    const T b = shortest_spline_time(turn, s.max_angular_velocity);
    return a > b || !(a == a) ? a : b;
  }
  static void slow(Reference& r, const OwnTime<T>& own) noexcept {
    r.A = own.rate * own.rate * r.A +
          Acceleration<P, Base, P, Base, T>{own.bend * r.V.linear, own.bend * r.V.angular};
    r.V = own.rate * r.V;
  }
  [[nodiscard]] static Reference ahead(const Reference& r, const T& t) noexcept {
    const Xyz<T> v = r.V.linear + T(0.5) * t * r.A.linear;
    const Xyz<T> turn = t * (r.V.angular + T(0.5) * t * r.A.angular);
    return {Where::trusted(exp_so3(turn) * r.X_BP.axes(), r.X_BP.origin() + t * v),
            {r.V.linear + t * r.A.linear, r.V.angular + t * r.A.angular},
            r.A};
  }
  [[nodiscard]] static bool finite(const Reference& r) noexcept {
    const T sum = dot(r.X_BP.origin(), r.X_BP.origin()) + dot(r.V.linear, r.V.linear) +
                  dot(r.V.angular, r.V.angular) + dot(r.A.linear, r.A.linear) + dot(r.A.angular, r.A.angular);
    return sum - sum == T(0) && rotation_error(r.X_BP.axes()) <= tolerance<T>;
  }
  /// A reference at the pose of `r` that goes on with constant velocity.
  [[nodiscard]] static Reference drifting(const Reference& r) noexcept { return {r.X_BP, r.V, {}}; }
  /// A reference at rest at the pose of `r`.
  [[nodiscard]] static Reference resting(const Reference& r) noexcept { return {r.X_BP, {}, {}}; }
  /// Moves `r` on by `dt` towards a target, within the limits: its origin, and its axes by the shortest turn.
  SKINCTL_COLD static void react(Reference& r, const Reference& target, const Settings& s,
                                 const T& dt) noexcept {
    const auto part = [&](const Xyz<T>& way, Xyz<T>& v, Xyz<T>& a, const Xyz<T>& v_t,
                          const PursuitLimits<T>& l) {
      Pursuit<3, T> three;
      put(three.v, v), put(three.a, a);
      T e[3], to[3], moved[3];
      put(e, way), put(to, v_t);
      three.advance(e, to, l, dt, moved);
      v = get(three.v), a = get(three.a);
      return get(moved);
    };
    const Xyz<T> p = part(target.X_BP.origin() - r.X_BP.origin(), r.V.linear, r.A.linear, target.V.linear,
                          {s.max_linear_velocity, s.max_linear_acceleration, s.max_linear_jerk});
    const Xyz<T> turn =
        part(log_so3(target.X_BP.axes() * r.X_BP.axes().transpose()), r.V.angular, r.A.angular,
             target.V.angular, {s.max_angular_velocity, s.max_angular_acceleration, s.max_angular_jerk});
    r.X_BP = Where::trusted(normalised(exp_so3(turn) * r.X_BP.axes()), r.X_BP.origin() + p);
  }
  [[nodiscard]] static bool allows(const Reference& r, const Settings& s) noexcept {
    const T sum =
        dot(r.X_BP.origin(), r.X_BP.origin()) + dot(r.A.linear, r.A.linear) + dot(r.A.angular, r.A.angular);
    return sum - sum == T(0) && rotation_error(r.X_BP.axes()) <= tolerance<T> &&
           norm(r.V.linear) < s.max_linear_velocity && norm(r.V.angular) < s.max_angular_velocity;
  }
  [[nodiscard]] static Errors distance(const Reference& a, const Reference& b) noexcept {
    Errors error{};
    put(error.e, a.X_BP.origin() - b.X_BP.origin());
    if constexpr (What == TaskSpace::pose)
      put(error.e + 3, log_so3(a.X_BP.axes() * b.X_BP.axes().transpose()));
    return error;
  }
  [[nodiscard]] static T slowness(const Errors& error, const Settings& s) noexcept {
    const auto time = [&](std::size_t first, const T& fastest) {
      const T speed = fastest - norm(get(error.v_d + first));
      return speed > T(0) ? T(norm(get(error.e + first)) / speed) : T(0);
    };
    const T a = time(0, s.max_linear_velocity);
    if constexpr (What == TaskSpace::position) return a;
    const T b = time(3 % coordinates, s.max_angular_velocity);
    return b > a ? b : a;
  }

  /// The speed by which the tool misses its course, as a share of the largest: linear or angular, the larger
  /// one.
  template <class Surface>
  [[nodiscard]] static SKINCTL_INLINE T share_of_speed(const Surface& surface, const Settings& s) noexcept {
    const auto missed = [&](std::size_t first, const T& fastest) {
      return norm(Xyz<T>{surface.S_delta[first], surface.S_delta[first + 1], surface.S_delta[first + 2]}) /
             fastest;
    };
    const T a = missed(0, s.max_linear_velocity);
    if constexpr (What == TaskSpace::position) return a;
    const T b = missed(3 % coordinates, s.max_angular_velocity);
    return b > a ? b : a;
  }

 protected:
  static SKINCTL_INLINE void put(T* to, const Xyz<T>& v) noexcept { to[0] = v.x, to[1] = v.y, to[2] = v.z; }
  [[nodiscard]] static SKINCTL_INLINE Xyz<T> get(const T* x) noexcept { return {x[0], x[1], x[2]}; }
};

SKINCTL_END_NAMESPACE
