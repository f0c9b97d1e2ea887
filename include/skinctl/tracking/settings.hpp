// What a tracking law in joint space is configured with, and what it refuses.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/robot/virtual_shape.hpp"
#include "skinctl/trajectory/gain_schedule.hpp"
#include "skinctl/trajectory/pursuit.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What happens to a goal that would need more speed than `max_velocity`.
enum class Reach : unsigned char {
  stretch,  ///< it gets more time (`Reason::goal_stretched`)
  refuse    ///< the old goal stands (`Reason::goal_refused`)
};

/// Gains and times of eqs. (8)-(14). Defaults follow `dt`, the longest interval for which a torque will be
/// held; everything is checked by the law's constructor, which throws `ConfigurationError`.
template <std::size_t N, Real T = double>
struct JointControlSettings {
  T dt = T(0.002);            ///< longest interval between two evaluations [s]
  T lambda = T(0.25) / dt;    ///< `K_d = lambda M(q)` [1/s]; 20-40 at 125 Hz, 50-150 at 500 Hz
  T kappa = T(10);            ///< decay of S_d [1/s]
  T K_i1 = T(1);              ///< gain of the integral of S_delta [1/s]
  T K_i2 = T(0.1);            ///< gain of the integral of tanh(mu S_delta) [rad/s^2]
  T mu = T(10);               ///< steepness of tanh [s/rad]
  T integral_limit = T(0.5);  ///< most that each integral adds to dq_r [rad/s]
  T tb = T(1);                ///< convergence time of the time base [s]; 0: the constant gain from the start
  T K_c = T(10);              ///< gain that holds the target [1/s]
  TimeBase<T> base{};         ///< shape of the time base
  T settle = T(0.5);          ///< duration of the way from the gain's peak to K_c, in multiples of tb
  T hand_over = T(0.1);       ///< time that the reference takes to its new course after a reset [s]
  T target_age = T(0.1);  ///< a moving target goes on for so long after its last sample, then slows down [s]
  T max_acceleration = T(4);  ///< of every joint after a reactive target [rad/s^2]
  T max_jerk = T(40);         ///< the same [rad/s^3]
  Reach reach = Reach::stretch;
  /// Of the robot that carries the torque, as in its resolver: `Y_r Theta` holds against inertia and
  /// friction, so that a slow virtual robot still tracks. Coulomb friction is left to the integrals.
  VirtualShape<N, T> shape = {};
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
  require(s.dt > T(0) && s.dt <= T(1), "dt", number(s.dt), "> 0 and <= 1 s");
  require(lambda > T(0) && lambda <= T(1e6), "lambda", number(lambda), "> 0 1/s");
  require(s.K_i1 >= T(0) && s.K_i1 <= T(1e6), "K_i1", number(s.K_i1), ">= 0 1/s");
  require(s.K_i2 >= T(0) && s.K_i2 <= T(1e6), "K_i2", number(s.K_i2), ">= 0 rad/s^2");
  require(s.mu > T(0) && s.mu <= T(1e6), "mu", number(s.mu), "> 0 s/rad");
  require(s.integral_limit > T(0) && s.integral_limit <= T(1e6), "integral_limit", number(s.integral_limit),
          "> 0 rad/s");
  require(s.kappa > T(0), "kappa", number(s.kappa), "> 0 1/s");
  require(s.kappa * s.dt <= T(0.3), "kappa dt", number(T(s.kappa * s.dt)), "<= 0.3");
  require(s.tb >= T(0) && s.tb <= T(1e6), "tb", number(s.tb), ">= 0 s");
  require(s.hand_over >= T(1e-9) && s.hand_over <= T(1e3), "hand_over", number(s.hand_over), "> 0 s");
  require(s.target_age >= T(1e-9) && s.target_age <= T(1e3), "target_age", number(s.target_age), "> 0 s");
  require(s.shape.decay >= T(0) && s.shape.decay <= T(1e4), "decay", number(s.shape.decay), "0 to 1e4 1/s");
  for (std::size_t i = 0; i < N; ++i) {
    require(s.shape.viscous[i] >= T(0) && s.shape.viscous[i] <= T(1e6), "viscous friction",
            number(s.shape.viscous[i]), "0 to 1e6 N m s/rad");
    require(s.shape.inertia[i] >= T(0) && s.shape.inertia[i] <= T(1e6), "added inertia",
            number(s.shape.inertia[i]), "0 to 1e6 kg m^2");
  }
  check(PursuitLimits<T>{T(1), s.max_acceleration, s.max_jerk});
  for (const T& v : s.max_velocity) require(v > T(0) && v <= T(1e6), "max_velocity", number(v), "> 0 rad/s");
  const T K_p = GainSchedule<T>(s.K_c, s.base, s.settle).largest(s.tb);
  const T product = (K_p + lambda + s.K_i1 + slope * s.K_i2) * s.dt;
  require(product <= largest_gain_product<T>, "(K_p + lambda + K_i1 + mu K_i2) dt", number(product),
          "<= 0.5: lower the gains, lengthen tb (K_p peaks at 14.5 / tb) or shorten dt");
}

/// The same with the sign by tanh.
template <std::size_t N, Real T>
SKINCTL_COLD void check(const JointControlSettings<N, T>& s, const T& lambda) {
  check(s, lambda, s.mu);
}

SKINCTL_END_NAMESPACE
