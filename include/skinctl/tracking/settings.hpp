// Settings of a tracking law in joint space, and their ranges.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/trajectory/gain_schedule.hpp"
#include "skinctl/trajectory/pursuit.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The treatment of a goal that would need more speed than `max_velocity`.
enum class GoalPolicy : unsigned char {
  stretch,  ///< it gets more time (`Reason::goal_stretched`)
  refuse    ///< the old goal is kept (`Reason::goal_refused`)
};

/// Gains and times of eqs. (8)-(14). Defaults follow `dt`, the longest interval for which a torque will be
/// held; everything is checked by the law's constructor, which throws `ConfigurationError`.
template <std::size_t N, Real T = double>
struct JointControlSettings {
  Nanoseconds dt = 2ms;                 ///< longest interval between two evaluations
  T lambda = T(0.25) / seconds<T>(dt);  ///< `K_d = lambda M(q)` [1/s]; 20-40 at 125 Hz, 50-150 at 500 Hz
  T kappa = T(10);                      ///< decay of S_d [1/s]
  T K_i1 = T(1);                        ///< gain of the integral of S_delta [1/s]
  T K_i2 = T(0.1);                      ///< gain of the integral of tanh(mu S_delta) [rad/s^2]
  T mu = T(10);                         ///< steepness of tanh [s/rad]
  T integral_limit = T(0.5);            ///< the largest contribution of each integral to dq_r [rad/s]
  Nanoseconds tb = 1s;  ///< convergence time of the time base; 0: the constant gain from the start
  T K_c = T(10);        ///< gain that holds the target [1/s]
  TimeBase<T> base{};   ///< shape of the time base
  T settle = T(0.5);    ///< duration of the change from the gain's peak to K_c, in multiples of tb
  Nanoseconds bumpless_transfer =
      100ms;  ///< bumpless transfer: the reference reaches its new course this long after a reset
  Nanoseconds target_age =
      100ms;  ///< a moving target is extrapolated so long after its last sample, then slows down
  T max_acceleration = T(4);  ///< of every joint after a reactive target [rad/s^2]
  T max_jerk = T(40);         ///< the same [rad/s^3]
  GoalPolicy reach = GoalPolicy::stretch;
  /// Of the robot that carries the torque, as in its resolver: `Y_r Theta` compensates its inertia and
  /// friction, so that a slow virtual robot still tracks. Coulomb friction is left to the integrals.
  VirtualDynamics<N, T> virtual_dynamics = {};
  JointVelocity<N, T> max_velocity = JointVelocity<N, T>::constant(T(1));  ///< of any motion to a goal
};

/// The largest `(K_p + lambda + K_i1 + mu K_i2) dt` that is accepted. 2 is the bound of stability in sampled
/// time, 0.84 with one cycle of delay.
template <Real T>
inline const T largest_gain_product = T(0.5);

/// Throws `ConfigurationError` with the number and the range, if a setting cannot work.
/// @param lambda  the largest rate [1/s] at which K_d alone stops the robot: lambda, or the largest
///                eigenvalue of M^-1 K_d.
/// @param slope   the steepest of the sign, mu for tanh [s/rad].
template <std::size_t N, Real T>
SKINCTL_COLD void check(const JointControlSettings<N, T>& s, const T& lambda, const T& slope) {
  const auto number = [](const T& x) { return static_cast<double>(x); };
  require(s.dt > 0ns && s.dt <= 1s, "dt", milliseconds(s.dt), "> 0 and <= 1000 ms");
  require(lambda > T(0) && lambda <= T(1e6), "lambda", number(lambda), "> 0 1/s");
  require(s.K_i1 >= T(0) && s.K_i1 <= T(1e6), "K_i1", number(s.K_i1), ">= 0 1/s");
  require(s.K_i2 >= T(0) && s.K_i2 <= T(1e6), "K_i2", number(s.K_i2), ">= 0 rad/s^2");
  require(s.mu > T(0) && s.mu <= T(1e6), "mu", number(s.mu), "> 0 s/rad");
  require(s.integral_limit > T(0) && s.integral_limit <= T(1e6), "integral_limit", number(s.integral_limit),
          "> 0 rad/s");
  require(s.kappa > T(0), "kappa", number(s.kappa), "> 0 1/s");
  const T dt = seconds<T>(s.dt);
  require(s.kappa * dt <= T(0.3), "kappa dt", number(T(s.kappa * dt)), "<= 0.3");
  require(s.tb >= 0ns && s.tb <= 1000000s, "tb", seconds<double>(s.tb), ">= 0 s");
  require(s.bumpless_transfer > 0ns && s.bumpless_transfer <= 1000s, "bumpless_transfer",
          milliseconds(s.bumpless_transfer), "> 0 ms, <= 1000 s");
  require(s.target_age > 0ns && s.target_age <= 1000s, "target_age", milliseconds(s.target_age),
          "> 0 ms, <= 1000 s");
  require(s.virtual_dynamics.damping >= T(0) && s.virtual_dynamics.damping <= T(1e4), "virtual damping",
          number(s.virtual_dynamics.damping), "0 to 1e4 1/s");
  for (std::size_t i = 0; i < N; ++i) {
    require(s.virtual_dynamics.viscous[i] >= T(0) && s.virtual_dynamics.viscous[i] <= T(1e6),
            "viscous friction", number(s.virtual_dynamics.viscous[i]), "0 to 1e6 N m s/rad");
    require(s.virtual_dynamics.inertia[i] >= T(0) && s.virtual_dynamics.inertia[i] <= T(1e6),
            "virtual inertia", number(s.virtual_dynamics.inertia[i]), "0 to 1e6 kg m^2");
  }
  check(PursuitLimits<T>{T(1), s.max_acceleration, s.max_jerk});
  for (const T& v : s.max_velocity) require(v > T(0) && v <= T(1e6), "max_velocity", number(v), "> 0 rad/s");
  const T K_p = GainSchedule<T>(s.K_c, s.base, s.settle).largest(seconds<T>(s.tb));
  const T product = (K_p + lambda + s.K_i1 + slope * s.K_i2) * dt;
  require(product <= largest_gain_product<T>, "(K_p + lambda + K_i1 + mu K_i2) dt", number(product),
          "<= 0.5: lower the gains, lengthen tb (K_p peaks at 14.5 / tb) or shorten dt");
}

/// Settings of a tracking law for this robot: times, virtual dynamics and speeds follow its description.
///
/// `dt` is the longest sub-step, that of a late cycle, so that the default `lambda` suits it too.
template <class Robot>
[[nodiscard]] JointControlSettings<Robot::joints, typename Robot::scalar> tracking_settings(
    const Robot& robot) {
  using T = typename Robot::scalar;
  JointControlSettings<Robot::joints, T> s{.dt = robot.longest_dt()};
  s.virtual_dynamics = robot.virtual_dynamics();
  for (std::size_t i = 0; i < Robot::joints; ++i)
    if (robot.limits().velocity()[i] < s.max_velocity[i]) s.max_velocity[i] = robot.limits().velocity()[i];
  return s;
}

/// Throws `ConfigurationError` with both numbers if a law's settings differ from those of the robot that
/// carries its torque.
template <std::size_t N, Real T>
SKINCTL_COLD void check_for(const JointControlSettings<N, T>& s, const LawTerms<N, T>& robot) {
  const auto same = [](const char* what, const T& ours, const T& theirs) {
    if (ours == theirs) return;
    char text[192];
    std::snprintf(text, sizeof text,
                  "skinctl: %s: %.9g in the law, %.9g in the robot's description: tracking_settings(robot) "
                  "takes it from there",
                  what, static_cast<double>(ours), static_cast<double>(theirs));
    refuse(text);
  };
  if (s.dt < robot.dt) {
    char text[192];
    std::snprintf(text, sizeof text,
                  "skinctl: dt: %.9g ms in the law, but in late cycles of the robot's description it is "
                  "evaluated every "
                  "%.9g ms: tracking_settings(robot) takes it from there",
                  milliseconds(s.dt), milliseconds(robot.dt));
    refuse(text);
  }
  const auto &ours = s.virtual_dynamics, &theirs = robot.virtual_dynamics;
  same("virtual damping", ours.damping, theirs.damping);
  for (std::size_t i = 0; i < N; ++i) {
    same("virtual inertia", ours.inertia[i], theirs.inertia[i]);
    same("viscous friction", ours.viscous[i], theirs.viscous[i]);
  }
}

/// The same with the sign by tanh.
template <std::size_t N, Real T>
SKINCTL_COLD void check(const JointControlSettings<N, T>& s, const T& lambda) {
  check(s, lambda, s.mu);
}

SKINCTL_END_NAMESPACE
