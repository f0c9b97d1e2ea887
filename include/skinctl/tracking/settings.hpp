// SPDX-License-Identifier: BSD-3-Clause
// Settings of a tracking law in joint space, and their ranges.
#pragma once

#include <cmath>
#include <limits>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/dynamics/mass_ratio.hpp"
#include "skinctl/law/law.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/tracking/detail/thresholds.hpp"
#include "skinctl/trajectory/gain_schedule.hpp"
#include "skinctl/trajectory/pursuit.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The treatment of a goal that would need more speed than `max_velocity`.
enum class GoalPolicy : unsigned char {
  stretch,  ///< the goal gets more time (`Reason::goal_stretched`)
  refuse    ///< the old goal is kept (`Reason::goal_refused`)
};

namespace detail {
/// Whether a goal or a target asks no joint to leave its position limits, where `known` has them; poses have
/// none.
template <class Space, class K, class Goal>
[[nodiscard]] constexpr bool within_limits(const K& known, const Goal& goal) noexcept {
  if constexpr (KnowsLimits<K> && Space::of_joints) {
    const auto& q = Space::place(goal);
    for (std::size_t i = 0; i < K::joints; ++i)
      if (!(q[i] >= known.limits().lower()[i] && q[i] <= known.limits().upper()[i])) return false;
  }
  return true;
}
}  // namespace detail

/// Gains and times of eqs. (8)-(14). Defaults follow `dt`, the longest interval for which a torque will be
/// held, and suit a virtual robot; those for a robot by torque, whose delay is in the loop, are made by
/// `tracking_settings`. Everything is checked by the law's constructor, which throws `ConfigurationError`.
template <std::size_t N, Real T = double>
struct JointControlSettings {
  Nanoseconds dt = 2ms;      ///< longest interval between two evaluations
  Nanoseconds loop_delay{};  ///< mean time from a state until the torque that answers it acts; dt if less
  /// Decay rate of `S_q = dq - dq_r` [1/s], by `K_d = lambda M(q)`; 20-40 at 125 Hz, 50-150 at 500 Hz. Half
  /// of `largest_gain_product`: the other half is for the gains inside.
  T lambda = T(0.25) / seconds<T>(dt);
  T kappa = T(10);  ///< decay rate of the surface's bias S_d [1/s]; no slower than K_c
  T K_i1 = T(1);    ///< gain of the integral of S_delta [1/s]; a tenth of K_c
  T K_i2 = T(0.1);  ///< gain of the integral of tanh(mu S_delta) [rad/s^2]; mu K_i2 = K_i1
  T mu = T(10);     ///< steepness of tanh [s/rad]: full above 0.1 rad/s
  /// Largest torque of the integrals at each joint of a robot by torque, `(K_d + B) J^+ (K_i1 I1 + K_i2 I2)`
  /// [N m]. 10: the friction of an arm's joints; `tracking_settings` takes half of the robot's torque.
  JointTorque<N, T> integral_limit = JointTorque<N, T>::constant(T(10));
  T integral_speed = T(0.5);  ///< largest part of an integral in dq_r of a frictionless robot [rad/s]
  Nanoseconds tb = 1s;        ///< convergence time of the time base; 0: the constant gain from the start
  T K_c = T(10);              ///< gain that holds the target [1/s]: an error is gone in 0.3 s
  TimeBase<T> base{};         ///< shape of the time base
  T settle = T(0.5);          ///< duration of the change from the gain's peak to K_c, in multiples of tb
  Nanoseconds bumpless_transfer =
      100ms;  ///< duration of the bumpless transfer after a reset, until the reference is on its new course
  Nanoseconds target_age =
      100ms;  ///< time after its last sample for which a moving target is extrapolated, before it slows down
  T max_acceleration = T(4);  ///< largest acceleration of any joint after a reactive target [rad/s^2]
  T max_jerk = T(40);         ///< largest jerk of any joint after a reactive target [rad/s^3]
  GoalPolicy reach = GoalPolicy::stretch;
  /// Speed by which the robot misses its course, as a share of `max_velocity`, at which a spline waits for
  /// it: it runs at a tenth of its pace from there on, at all of it up to half of that. For limits that slow
  /// the robot: it does not pull ever harder; infinite: it never waits.
  T waits = std::numeric_limits<T>::infinity();
  /// Inertia and friction of the robot that carries the torque, as in its resolver: `Y_r Theta` compensates
  /// them, so that a slow virtual robot still tracks. Coulomb friction is left to the integrals.
  VirtualDynamics<N, T> virtual_dynamics = {};
  T mass_ratio = T(1);  ///< factor by which the robot may be lighter than the law's model, see `mass_ratio`
  /// Rate at which the weight of a payload other than told drives the robot from a pose, see `gravity_rate`
  /// [1/s^2].
  T gravity_rate = T(0);
  /// Largest speed to a goal [rad/s].
  JointVelocity<N, T> max_velocity = JointVelocity<N, T>::constant(T(1));
  /// Largest acceleration of each joint on a spline or after a reactive target [rad/s^2].
  JointAcceleration<N, T> joint_acceleration =
      JointAcceleration<N, T>::constant(std::numeric_limits<T>::infinity());

  /// Delay D of the loop, for which the gains must be small enough: `loop_delay`, at least `dt`.
  [[nodiscard]] constexpr Nanoseconds delay_in_loop() const noexcept {
    return loop_delay < dt ? dt : loop_delay;
  }
};

/// The largest `(K_p + lambda + K_i1 + mu K_i2) D` that is accepted, D the loop's delay, K_p the time base's
/// largest gain. Alone, `lambda D` is stable to 1.0: a gain margin of 2. A virtual robot is stable to 2.
template <Real T>
inline const T largest_gain_product = T(0.5);
/// The largest gain product, as of `largest_gain_product`, times the mass ratio that is accepted: up to it
/// the lightest robot is stable.
template <Real T>
inline const T largest_product_when_light = T(1);
/// The largest mass ratio that is accepted. Beyond it no gains are stable for the light robot and hold the
/// heavy one. A UR5 that may have lost 5 kg has 77 to 115 without the inertia of its rotors, 4 with 0.1 kg
/// m^2 at each joint.
template <Real T>
inline const T largest_mass_ratio = T(4);
/// The largest acceleration for which integrals by torque may ask a joint whose motor's inertia is not
/// declared [rad/s^2]: integrals swing a joint that is over eight times heavier than declared, as a wrist is
/// with its motors, and the torque bounds how far. A UR5 with 0.05 kg m^2 at each joint then stays below 0.8
/// rad/s, with 60 it reaches 1.5.
template <Real T>
inline const T largest_integral_acceleration = T(20);
/// The largest `kappa dt` that is accepted: the bias is then known within a step.
inline constexpr double largest_bias_step = 0.3;

namespace detail {
template <Real T>
SKINCTL_COLD void check_mass_ratio(const T& mass_ratio) {
  require(mass_ratio >= T(1) && mass_ratio <= largest_mass_ratio<T>, "mass ratio",
          static_cast<double>(mass_ratio),
          "1 to 4: declare the rotors' inertia (virtual_inertia), which is in both masses");
}
/// Throws with the numbers for gains too large for the loop's delay or for a robot lighter by `mass_ratio`,
/// and for a mass ratio out of its range. Arguments as of `check`.
template <std::size_t N, Real T>
SKINCTL_COLD void check_gains(const JointControlSettings<N, T>& s, const T& lambda, const T& mass_ratio) {
  const auto number = [](const T& x) { return static_cast<double>(x); };
  check_mass_ratio(mass_ratio);
  const T K_p = GainSchedule<T>(s.K_c, s.base, s.settle).largest(seconds<T>(s.tb));
  const T product = (K_p + lambda + s.K_i1 + s.mu * s.K_i2) * seconds<T>(s.delay_in_loop());
  const T light = largest_product_when_light<T> / mass_ratio;
  const T largest = light < largest_gain_product<T> ? light : largest_gain_product<T>;
  if (s.delay_in_loop() == s.dt)
    require(product <= largest, "(K_p + lambda + K_i1 + mu K_i2) dt", number(product),
            "<= 0.5: lower the gains, lengthen tb (K_p peaks at 14.5 / tb) or shorten dt");
  if (product <= largest) return;
  char text[384];
  std::snprintf(
      text, sizeof text,
      "skinctl: (K_p + lambda + K_i1 + mu K_i2) D = %.9g, allowed: <= %.3g, with D = %.9g ms and joints up "
      "to %.3g times lighter: stable up to %.3g times the gain, or joints %.3g times lighter. Lower the "
      "gains, lengthen tb (K_p peaks at 14.5 / tb) or shorten the delay",
      number(product), number(largest), milliseconds(s.delay_in_loop()), number(mass_ratio),
      number(T(light / product)), number(T(T(1) / product)));
  refuse(text);
}
/// Throws with the numbers for gains too small to hold the gravity of another payload than told, by Routh's
/// criterion for `s^2 + lambda (s + K_c)(1 + K_i1 / s)` with its falling away: without integral `lambda K_c`
/// has to be larger.
template <std::size_t N, Real T>
SKINCTL_COLD void check_gravity(const JointControlSettings<N, T>& s, const T& lambda, const T& gravity_rate) {
  const auto number = [](const T& x) { return static_cast<double>(x); };
  require(gravity_rate >= T(0), "gravity rate", number(gravity_rate), ">= 0 1/s^2");
  const T K = s.K_c, Ix = s.K_i1;
  const T holds = lambda * K + (lambda + K) * Ix - lambda * K * Ix / (lambda + K + Ix);
  if (holds >= gravity_rate) return;
  char text[320];
  std::snprintf(text, sizeof text,
                "skinctl: lambda (K_c + K_i1) + K_c K_i1 - lambda K_c K_i1 / (lambda + K_c + K_i1) = %.9g "
                "1/s^2, allowed: >= %.3g, or a lost payload's gravity carries a joint away: declare the "
                "rotors' inertia, shorten the delay or tell the payload",
                number(holds), number(gravity_rate));
  refuse(text);
}
}  // namespace detail

/// Throws `ConfigurationError` with the number and the range, if a setting cannot work.
/// @param lambda  the largest rate [1/s] at which K_d alone stops the robot: lambda, or the largest
///                eigenvalue of M^-1 K_d.
template <std::size_t N, Real T>
SKINCTL_COLD void check(const JointControlSettings<N, T>& s, const T& lambda) {
  const auto number = [](const T& x) { return static_cast<double>(x); };
  require(s.dt > 0ns && s.dt <= 1s, "dt", milliseconds(s.dt), "> 0 and <= 1000 ms");
  require(s.loop_delay >= 0ns && s.loop_delay <= 10s, "loop_delay", milliseconds(s.loop_delay),
          "0 to 10 000 ms");
  require(lambda > T(0) && lambda <= T(1e6), "lambda", number(lambda), "> 0 1/s");
  require(s.K_i1 >= T(0) && s.K_i1 <= T(1e6), "K_i1", number(s.K_i1), ">= 0 1/s");
  require(s.K_i2 >= T(0) && s.K_i2 <= T(1e6), "K_i2", number(s.K_i2), ">= 0 rad/s^2");
  require(s.mu > T(0) && s.mu <= T(1e6), "mu", number(s.mu), "> 0 s/rad");
  for (const T& limit : s.integral_limit)
    require(limit > T(0) && limit <= T(1e6), "integral_limit", number(limit), "> 0 N m");
  require(s.integral_speed > T(0) && s.integral_speed <= T(1e6), "integral_speed", number(s.integral_speed),
          "> 0 rad/s");
  require(s.kappa > T(0), "kappa", number(s.kappa), "> 0 1/s");
  const T dt = seconds<T>(s.dt);
  require(s.kappa * dt <= T(largest_bias_step), "kappa dt", number(T(s.kappa * dt)), "<= 0.3");
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
  require(s.waits > T(0), "waits", number(s.waits), "> 0, or infinite");
  check(PursuitLimits<T>{T(1), s.max_acceleration, s.max_jerk});
  for (const T& v : s.max_velocity) require(v > T(0) && v <= T(1e6), "max_velocity", number(v), "> 0 rad/s");
  for (const T& a : s.joint_acceleration)
    require(a > T(0), "joint_acceleration", number(a), "> 0 rad/s^2, or infinite");
  detail::check_gains(s, lambda, s.mass_ratio);
}

namespace detail {
/// Gains `K_c` and `K_i1` over `lambda`: the damping, the inner loop, is four times as fast as these two.
inline constexpr double inner_share = 0.25;
/// Ratio of `lambda` [1/s] to the gain `K_i2` [rad/s^2] of the second integral: with its steepness mu = 10,
/// `mu K_i2` takes an eighth of lambda from the margin.
inline constexpr int lambda_over_K_i2 = 80;

/// Gains behind a delay D in the loop [s]: `lambda = 0.3 / D`, less than a third of what is stable (see
/// `largest_gain_product`), and slower ones inside of it, no faster than without a delay.
template <std::size_t N, Real T>
void follow_delay(JointControlSettings<N, T>& s, const T& delay) {
  s.lambda = T(gain_times_delay) / delay;
  s.K_c = s.K_i1 = T(inner_share) * s.lambda < s.K_c ? T(inner_share) * s.lambda : s.K_c;
  s.K_i2 = s.lambda / T(lambda_over_K_i2);
}
/// Gains that wait for the acceleration: `(lambda + k) K_c (A/J)^2 <= 1` of each joint, k the rate of its
/// viscous friction [1/s], A/J the time in which the jerk builds up its acceleration, see `jerk_terms`.
template <std::size_t N, Real T>
void fit_jerk(JointControlSettings<N, T>& s, const JerkTerms<N, T>& limit) {
  using std::sqrt;
  T share = T(1), lambda = std::numeric_limits<T>::infinity();  // of both gains; with K_c = lambda / 2
  for (std::size_t i = 0; i < N; ++i) {
    const T r = limit.rise[i], k = limit.friction[i], once = k * s.K_c * r * r,
            twice = s.lambda * s.K_c * r * r;
    if (r == T(0)) continue;
    if (const T most = T(2) / (once + sqrt(once * once + T(4) * twice)); most < share) share = most;
    if (const T most = T(4) / (r * (k * r + sqrt(k * r * (k * r) + T(8)))); most < lambda) lambda = most;
  }
  if (!(share < T(1))) return;
  s.lambda *= share, s.K_c *= share, s.K_i1 *= share, s.K_i2 *= share * share;
  if (s.K_c > T(0.5) * s.lambda) s.lambda = lambda, s.K_c = T(0.5) * lambda;
}
}  // namespace detail

/// Settings of a tracking law for this robot: times, virtual dynamics and speeds follow its description.
///
/// By position or velocity `dt` is the longest sub-step, that of a late cycle, so that the default `lambda`
/// suits it too. By torque the gains follow the loop's delay D: `lambda = 0.3 / (D max(1, mass_ratio / 2))`,
/// `K_c = K_i1 = min(10, lambda / 4)`, `K_i2 = lambda / 80`, which the bounds allow. There is no time base:
/// it begins with no gain at all, while friction has to be overcome. The integrals may use half of a joint's
/// torque: friction and a lost payload take less; without the motors' inertia see
/// `largest_integral_acceleration`.
///
/// @param mass_ratio  how many times lighter the robot may be than its model; by torque 1 to 4, else throws
///                    `ConfigurationError`; not read by position or velocity.
template <class Robot>
[[nodiscard]] JointControlSettings<Robot::joints, typename Robot::scalar> tracking_settings(
    const Robot& robot, const typename Robot::scalar& mass_ratio = typename Robot::scalar(1)) {
  using T = typename Robot::scalar;
  JointControlSettings<Robot::joints, T> s{.dt = robot.longest_dt()};
  s.virtual_dynamics = robot.virtual_dynamics();
  for (std::size_t i = 0; i < Robot::joints; ++i) {
    if (robot.limits().velocity()[i] < s.max_velocity[i]) s.max_velocity[i] = robot.limits().velocity()[i];
    s.joint_acceleration[i] = T(detail::planned_share) * robot.limits().acceleration()[i];
  }
  if constexpr (Robot::interface == Interface::torque) {
    detail::check_mass_ratio(mass_ratio);
    const T half = T(0.5) * mass_ratio;
    s.loop_delay = robot.loop_delay();
    s.mass_ratio = mass_ratio;
    detail::follow_delay(s, T(seconds<T>(s.delay_in_loop()) * (half > T(1) ? half : T(1))));
    const auto inertia = inertia_range(robot.model(), s.virtual_dynamics.inertia).most;
    for (std::size_t i = 0; i < Robot::joints; ++i) {
      s.integral_limit[i] = T(0.5) * robot.limits().torque()[i];
      const T least = largest_integral_acceleration<T> * inertia[i];
      if (!(s.virtual_dynamics.inertia[i] > T(0)) && least < s.integral_limit[i]) s.integral_limit[i] = least;
    }
    s.tb = 0ns;
  }
  return s;
}
/// Settings by position or velocity for a scene with `MaxJerk`. A joint takes A/J to bring up its
/// acceleration: with `(lambda + k) K_c (A/J)^2 > 1`, k the rate of the viscous friction that the law feeds
/// forward, a touch that leads the arm from its goal may leave it swinging about it for ever. Both gains are
/// lowered alike, and K_c to half of lambda at most.
template <class Robot, class T = typename Robot::scalar>
  requires(Robot::interface != Interface::torque)
[[nodiscard]] JointControlSettings<Robot::joints, T> tracking_settings(
    const Robot& robot, const JointJerk<Robot::joints, T>& jerk) {
  auto s = tracking_settings(robot);
  detail::fit_jerk(s, jerk_terms(robot.model(), s.virtual_dynamics, robot.limits().acceleration(), jerk,
                                 seconds<T>(robot.dt())));
  return s;
}
/// Settings by torque for a robot that may lose its payload: `lightest` describes it without.
template <DescribedRobot Robot, DescribedRobot Lightest>
  requires(Robot::interface == Interface::torque && Robot::joints == Lightest::joints)
[[nodiscard]] JointControlSettings<Robot::joints, typename Robot::scalar> tracking_settings(
    const Robot& robot, const Lightest& lightest) {
  const auto& motors = robot.virtual_dynamics().inertia;
  auto s = tracking_settings(robot, mass_ratio(robot.model(), lightest.model(), motors));
  s.gravity_rate = gravity_rate(robot.model(), lightest.model(), motors);
  return s;
}

SKINCTL_END_NAMESPACE
