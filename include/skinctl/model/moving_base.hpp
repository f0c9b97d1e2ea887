// SPDX-License-Identifier: BSD-3-Clause
// Robots whose base is carried around: on a cart, a mobile platform, another robot.
#pragma once

#include "skinctl/core/time.hpp"
#include "skinctl/frames/acceleration.hpp"
#include "skinctl/model/weightless.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The motion of a robot's base in an inertial world whose z axis points up, as odometry and an inertial unit
/// tell it.
///
/// Everything is of the body before joint 0, at the origin of `Base`. Velocity and acceleration are
/// **relative to World, along the axes of Base**: a base that drives along its x axis has `V_WB_B.linear =
/// {v, 0, 0}` wherever it heads. `A_WB_B.linear` is d^2p/dt^2 of that point, **zero for a base that stands,
/// also on a slope** (an accelerometer there reads +g along its upward axis: take that off), and v^2/r
/// towards the middle of a curve. It is not the "spatial" acceleration of screw theory.
template <Real T = double>
struct BaseState {
  Nanoseconds time{};                        ///< stamp, by the clock of the cycle; 0 before the first one
  Transform<World, Base, T> X_WB;            ///< pose of Base in World
  Twist<Base, World, Base, Base, T> V_WB_B;  ///< velocity [m/s], [rad/s]
  Acceleration<Base, World, Base, Base, T>
      A_WB_B;           ///< rate of change of the velocity, without gravity [m/s^2], [rad/s^2]
  T sigma = T(0);       ///< standard deviation of the position, along each axis [m]
  T sigma_turn = T(0);  ///< standard deviation of the orientation, about each axis [rad]
};

/// The addition of a robot on a moving base to the input of a cycle.
template <Real T = double>
struct BaseInput {
  BaseState<T> base;  ///< the newest state of the base, with its own stamp
};
/// Calls `f` with the plain numbers of a base's state, for recordings.
template <Real T, class F>
void each_number(BaseInput<T>& input, F&& f) {
  BaseState<T>& b = input.base;
  auto time = b.time.count();
  f(time);
  b.time = Nanoseconds(time);
  auto R = b.X_WB.axes();
  auto p = b.X_WB.origin();
  for (Xyz<T>* v :
       {&R.x, &R.y, &R.z, &p, &b.V_WB_B.linear, &b.V_WB_B.angular, &b.A_WB_B.linear, &b.A_WB_B.angular})
    f(v->x), f(v->y), f(v->z);
  b.X_WB = Transform<World, Base, T>::trusted(R, p);
  f(b.sigma), f(b.sigma_turn);
}

/// The ranges in which a state of a base counts, and for how long.
struct MovingBaseSettings {
  double max_rate = 5;           ///< largest angular velocity of a base [rad/s], > 0, <= 100
  double max_acceleration = 30;  ///< largest acceleration of its origin [m/s^2], > 0, <= 1000
  double max_turning = 100;      ///< largest angular acceleration of a base [rad/s^2], > 0, <= 1e4
  Nanoseconds max_age = 100ms;   ///< age from which the motion of the base does not count any more, <= 10 s
  Nanoseconds fade = 50ms;       ///< last part of `max_age`, in which the motion fades, > 0, <= max_age
  Nanoseconds max_ahead = 50ms;  ///< largest time by which a stamp may be later than the cycle, 0 to 1 s
};

/// `M` on a base that is moved by others: `by_torque(OnMovingBase(model), ...)`. The input of its scene has
/// `input.base`, a `BaseState`. Other wrappers of a model (`Loaded`, `Mounted`) go inside.
///
/// **Torque.** Laws know the robot as if its base stood as `M` says (upright). What the base's motion adds,
/// the recursion of dynamics that begins with V_WB and `A_WB - g` less that of the base at rest, is sent to
/// the joints by torque on top of what laws ask for, also while they brake and hold: the arm weighs what it
/// weighs on the slope, and stays behind neither in a curve nor when the base starts. Joints by position and
/// velocity hold it by themselves.
///
/// **Touch.** `WristSensor` and `MotorTouch` take the base's motion off, if made with this model.
///
/// **Limits** are the robot's in its base: `MaxToolSpeed` is a speed in Base, to which that of the base is
/// added; what is around is given in Base. (For a base that gives way put its joints before the arm's:
/// examples/36_moving_base.cpp.)
///
/// **Bad input.** Refused, and the last good state stands: a number that is NaN or infinite
/// (`sample_not_finite`); axes that are no rotation, a rate or an acceleration beyond the settings, a stamp
/// too far ahead (`sample_out_of_range`). A stamp that is not later than the last one is no news. Without
/// news the base is taken to turn on for `max_age`, its motion fading in the last part; then it is where it
/// was, at rest: the last slope still counts (`sample_stale`). Before the first state it stands as `M` says
/// (`sample_stale`). A leap of its torque is cut to `torque_rate` (`step_limited`).
template <RobotModel M>
class OnMovingBase : public M {
 public:
  static constexpr bool on_moving_base = true;

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit OnMovingBase(const M& model, const MovingBaseSettings& s = {}) : M(model), s_(s) {
    const auto within = [](double x, double most, const char* what, const char* range) {
      require(x > 0 && x <= most, what, x, range);
    };
    within(s.max_rate, 100, "OnMovingBase: max_rate", "> 0, <= 100 rad/s");
    within(s.max_acceleration, 1000, "OnMovingBase: max_acceleration", "> 0, <= 1000 m/s^2");
    within(s.max_turning, 1e4, "OnMovingBase: max_turning", "> 0, <= 1e4 rad/s^2");
    within(milliseconds(s.fade), milliseconds(s.max_age), "OnMovingBase: fade", "> 0, <= max_age [ms]");
    within(milliseconds(s.max_age), 1e4, "OnMovingBase: max_age", "> 0, <= 1e4 ms");
    require(s.max_ahead >= 0ns && s.max_ahead <= 1s, "OnMovingBase: max_ahead", milliseconds(s.max_ahead),
            "0 to 1000 ms");
  }
  [[nodiscard]] const MovingBaseSettings& base_settings() const noexcept { return s_; }
  /// The model of the same robot on a base that stands.
  [[nodiscard]] const M& at_rest() const noexcept { return *this; }

 private:
  MovingBaseSettings s_;
};

namespace detail {
template <class M>
struct MovesBase : std::false_type {
  static_assert(!SaysMovingBase<M>, "OnMovingBase goes outside: OnMovingBase(Loaded(model, part))");
};
template <class M>
struct MovesBase<OnMovingBase<M>> : std::true_type {};
template <class M>
struct MovesBase<Weightless<OnMovingBase<M>>> : std::true_type {};
}  // namespace detail

/// Whether the base of a robot with the model `M` moves.
template <class M>
inline constexpr bool base_moves = detail::MovesBase<M>::value;

SKINCTL_END_NAMESPACE
