#include "examples/simulated_ur5/arm.hpp"

#include <algorithm>
#include <cmath>

#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

bool finite(const Joints& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

double largest(const Joints& v) {
  double m = 0;
  for (double x : v) m = std::max(m, std::abs(x));
  return m;
}

/// Largest speed from which a stop within `distance` is possible when speed changes by at most `a dt` per
/// step.
double brakeable(double distance, double a, double dt) {
  return a * (std::sqrt(0.25 * dt * dt + 2 * distance / a) - 0.5 * dt);
}

}  // namespace

void check(const ArmConfig& c) {
  using skinctl::require;
  require(c.delay >= 0 && c.delay <= 0.5, "delay", c.delay, "0 to 0.5 s");
  require(c.lag >= 0 && c.lag <= 0.5, "lag", c.lag, "0 to 0.5 s");
  require(c.step_tolerance >= 1 && c.step_tolerance <= 1000, "step tolerance", c.step_tolerance, "1 to 1000");
  require(c.integral_time >= 0.01, "integral time", c.integral_time, "0.01 s to infinite");
  require(c.unknown_payload >= 0 && c.unknown_payload <= 20, "unknown payload", c.unknown_payload,
          "0 to 20 kg");
  require(c.position_noise >= 0 && c.position_noise <= 0.1, "position noise", c.position_noise,
          "0 to 0.1 rad");
  require(c.velocity_noise >= 0 && c.velocity_noise <= 1, "velocity noise", c.velocity_noise, "0 to 1 rad/s");
  require(c.protective_deceleration > 0 && c.protective_deceleration <= 1e4, "protective deceleration",
          c.protective_deceleration, "> 0 to 1e4 rad/s^2");
  require(c.drives.presliding >= 1e-5 && c.drives.presliding <= 0.1, "way of presliding", c.drives.presliding,
          "1e-5 to 0.1 rad");
  require(c.warming >= 0 && c.warming <= 80, "warming", c.warming, "0 to 80 K");
  require(c.warming_time >= 1 && c.warming_time <= 1e5, "warming time", c.warming_time, "1 to 1e5 s");
  require(c.friction_per_kelvin >= 0 && c.friction_per_kelvin <= 0.1, "friction per kelvin",
          c.friction_per_kelvin, "0 to 0.1 1/K");
  for (std::size_t i = 0; i < joint_count; ++i) {
    require(std::abs(c.torque_bias[i]) <= 1000, "torque bias", c.torque_bias[i], "-1000 to 1000 N m");
    require(std::abs(c.torque_creep[i]) <= 100, "torque creep", c.torque_creep[i], "-100 to 100 N m/s");
    require(c.stiffness[i] >= 100, "stiffness", c.stiffness[i], "100 N m/rad to infinite");
    require(c.velocity_limit[i] > 0 && c.velocity_limit[i] <= 100, "velocity limit", c.velocity_limit[i],
            "> 0 to 100 rad/s");
    require(c.acceleration_limit[i] > 0 && c.acceleration_limit[i] <= 1e5, "acceleration limit",
            c.acceleration_limit[i], "> 0 to 1e5 rad/s^2");
    require(c.lower[i] >= -1000 && c.lower[i] < c.upper[i], "lower joint limit", c.lower[i],
            "below the upper one");
    require(c.upper[i] <= 1000, "upper joint limit", c.upper[i], "<= 1000 rad");
    require(c.drives.rotor_inertia[i] >= 1e-3 && c.drives.rotor_inertia[i] <= 100, "rotor inertia",
            c.drives.rotor_inertia[i], "1e-3 to 100 kg m^2");
    require(c.drives.viscous[i] >= 0 && c.drives.viscous[i] <= 1000, "viscous friction", c.drives.viscous[i],
            "0 to 1000 N m s/rad");
    require(c.drives.coulomb[i] >= 0 && c.drives.coulomb[i] <= 1000, "Coulomb friction", c.drives.coulomb[i],
            "0 to 1000 N m");
    require(c.torque_noise[i] >= 0 && c.torque_noise[i] <= 100, "torque noise", c.torque_noise[i],
            "0 to 100 N m");
    require(c.torque_limit[i] > 0 && c.torque_limit[i] <= 1e4, "torque limit", c.torque_limit[i],
            "> 0 to 1e4 N m");
    require(c.home[i] >= c.lower[i] && c.home[i] <= c.upper[i], "home position", c.home[i],
            "within the joint limits");
  }
}

Arm::Arm(const ArmConfig& config, Nanoseconds cycle)
    : config_(config),
      cycle_(cycle),
      dt_(seconds(cycle)),
      drives_(config.drives),
      lag_(config.lag),
      target_q_(config.home),
      q_(config.home),
      measured_q_(config.home),
      q_before_(config.home),
      driven_(config.home) {
  check(config);
  skinctl::require(cycle >= plant_step && cycle % plant_step == 0, "cycle", seconds(cycle),
                   "a multiple of 0.5 ms");
  history_.assign(static_cast<std::size_t>(nanoseconds(config.delay) / cycle) + 3, config.home);
}

void Arm::servo(const Joints& q, double lookahead, double gain) {
  if (mode_ == Mode::torque) back_to_position_control();
  if (mode_ != Mode::servo) last_command_ = ahead_ = target_q_;
  command_ = q;
  mode_ = Mode::servo;
  lookahead_ = std::isfinite(lookahead) ? std::clamp(lookahead, 0.03, 0.2) : 0.03;
  lag_ = config_.lag * 2000 / (std::isfinite(gain) ? std::clamp(gain, 100.0, 2000.0) : 2000);
}

void Arm::speed(const Joints& dq, double acceleration) {
  if (mode_ == Mode::torque) back_to_position_control();
  command_ = dq;
  acceleration_ = std::isfinite(acceleration) && acceleration > 0 ? acceleration : 40;
  mode_ = Mode::speed;
  lag_ = config_.lag;
}

void Arm::stop(double deceleration) {
  if (mode_ == Mode::torque) {
    mode_ = Mode::stop;
    back_to_position_control();
  }
  deceleration_ = std::isfinite(deceleration) && deceleration > 0 ? deceleration : 4;
  mode_ = Mode::stop;
  lag_ = config_.lag;
}

void Arm::move(const Joints& q, double acceleration, double velocity, double duration) {
  if (mode_ == Mode::torque) back_to_position_control();
  path_ = Path{};
  path_.from = target_q_;
  path_.to = q;
  for (std::size_t i = 0; i < joint_count; ++i)
    path_.length = std::max(path_.length, std::abs(q[i] - target_q_[i]));
  const double a_max =
      *std::min_element(config_.acceleration_limit.begin(), config_.acceleration_limit.end());
  const double v_max = *std::min_element(config_.velocity_limit.begin(), config_.velocity_limit.end());
  double a = std::clamp(std::isfinite(acceleration) ? acceleration : 1.4, 1e-3, a_max);
  double v = std::clamp(std::isfinite(velocity) ? velocity : 1.05, 1e-3, v_max);
  if (std::isfinite(duration) && duration > 0) {
    // Ramps of a quarter of the time each, unless that is beyond what the arm can do.
    v = std::min(v_max, path_.length / (0.75 * duration));
    a = std::min(a_max, std::max(1e-3, v / (0.25 * duration)));
    v = std::max(v, 1e-6);
  }
  path_.peak = std::min(v, std::sqrt(a * path_.length));
  path_.ramp = path_.peak / a;
  path_.total = path_.peak > 0 ? path_.length / path_.peak + path_.ramp : 0;
  mode_ = Mode::move;
  lag_ = config_.lag;
}

void Arm::apply_speeds(const Joints& next) {
  for (std::size_t i = 0; i < joint_count; ++i) {
    target_ddq_[i] = (next[i] - target_dq_[i]) / dt_;
    target_q_[i] += 0.5 * (target_dq_[i] + next[i]) * dt_;
    target_dq_[i] = next[i];
  }
}

Violation Arm::plan_servo(double fraction) {
  if (!finite(command_)) return Violation::not_a_number;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const double needed = std::abs(command_[i] - target_q_[i]) / dt_;
    const double step = std::abs(command_[i] - last_command_[i]) / dt_;
    if (std::min(needed, step) > config_.step_tolerance * config_.velocity_limit[i])
      return Violation::position_step;
  }
  const double left = std::exp(-dt_ / lookahead_);
  for (std::size_t i = 0; i < joint_count; ++i) {
    const double a = config_.acceleration_limit[i], v_max = config_.velocity_limit[i];
    // The command behind its lookahead, exact for one that is linear in between.
    const double slope = (command_[i] - last_command_[i]) / dt_, was = ahead_[i];
    ahead_[i] = command_[i] - slope * lookahead_ + (was - last_command_[i] + slope * lookahead_) * left;
    // Seen from there: close the distance at a speed from which the arm can still brake.
    const double command_speed = (ahead_[i] - was) / dt_;
    const double behind = was - target_q_[i];
    const double most = brakeable(std::abs(behind), a, dt_);
    // And from the command itself: a lookahead brakes a great step harder than the arm can.
    const double left_over = last_command_[i] - target_q_[i];
    const double nearest = brakeable(std::abs(left_over), a, dt_);
    const double wanted =
        std::clamp(command_speed + std::clamp(behind / dt_, -most, most),
                   slope - (left_over < 0 ? nearest : rigid), slope + (left_over > 0 ? nearest : rigid)) *
        fraction;
    const double v =
        std::clamp(std::clamp(wanted, -v_max, v_max), target_dq_[i] - a * dt_, target_dq_[i] + a * dt_);
    const double step = v * dt_;
    const double q = std::abs(ahead_[i] - target_q_[i] - step) < 1e-12 ? ahead_[i] : target_q_[i] + step;
    target_ddq_[i] = (v - target_dq_[i]) / dt_;
    target_dq_[i] = v;
    target_q_[i] = q;
  }
  last_command_ = command_;
  return Violation::none;
}

Violation Arm::plan_speed(double fraction) {
  if (!finite(command_)) return Violation::not_a_number;
  Joints change{}, next{};
  double scale = 1;
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (std::abs(command_[i]) > config_.step_tolerance * config_.velocity_limit[i]) return Violation::speed;
    const double wanted =
        std::clamp(command_[i] * fraction, -config_.velocity_limit[i], config_.velocity_limit[i]);
    change[i] = wanted - target_dq_[i];
    const double allowed = std::min(acceleration_, config_.acceleration_limit[i]) * dt_;
    if (std::abs(change[i]) > allowed) scale = std::min(scale, allowed / std::abs(change[i]));
  }
  for (std::size_t i = 0; i < joint_count; ++i) next[i] = target_dq_[i] + scale * change[i];
  apply_speeds(next);
  return Violation::none;
}

void Arm::plan_stop() {
  const double leading = largest(target_dq_);
  const double left = leading > deceleration_ * dt_ ? 1 - deceleration_ * dt_ / leading : 0;
  Joints next{};
  for (std::size_t i = 0; i < joint_count; ++i) next[i] = left * target_dq_[i];
  apply_speeds(next);
}

void Arm::plan_move(double fraction) {
  path_.elapsed = std::min(path_.total, path_.elapsed + fraction * dt_);
  const double t = path_.elapsed, rest = path_.total - t;
  double s = path_.length;
  if (t < path_.total) {
    const double a = path_.ramp > 0 ? path_.peak / path_.ramp : 0;
    if (t < path_.ramp)
      s = 0.5 * a * t * t;
    else if (rest < path_.ramp)
      s = path_.length - 0.5 * a * rest * rest;
    else
      s = path_.peak * (t - 0.5 * path_.ramp);
  }
  const double share = path_.length > 0 ? s / path_.length : 1;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const double q = t < path_.total ? path_.from[i] + share * (path_.to[i] - path_.from[i]) : path_.to[i];
    const double v = (q - target_q_[i]) / dt_;
    target_ddq_[i] = (v - target_dq_[i]) / dt_;
    target_dq_[i] = v;
    target_q_[i] = q;
  }
  if (t >= path_.total && largest(target_dq_) < 1e-9) mode_ = Mode::stop;
}

Violation Arm::plan(double speed_fraction) {
  const double fraction = std::clamp(speed_fraction, 0.0, 1.0);
  Violation violation = Violation::none;
  if (mode_ == Mode::torque && !torque_is_fresh_) stop(config_.protective_deceleration);
  switch (mode_) {
    case Mode::stop:
      plan_stop();
      break;
    case Mode::servo:
      violation = plan_servo(fraction);
      break;
    case Mode::speed:
      violation = plan_speed(fraction);
      break;
    case Mode::move:
      plan_move(fraction);
      break;
    case Mode::torque:
      violation = plan_torque();
      break;
  }
  if (violation != Violation::none) {
    stop(config_.protective_deceleration);
    plan_stop();
  } else {
    for (std::size_t i = 0; i < joint_count; ++i) {
      const bool outward = (target_q_[i] > config_.upper[i] && target_dq_[i] > 0) ||
                           (target_q_[i] < config_.lower[i] && target_dq_[i] < 0);
      if (outward) violation = Violation::joint_limit;
    }
    if (violation != Violation::none) stop(config_.protective_deceleration);
  }
  ++planned_;
  history_[static_cast<std::size_t>(planned_) % history_.size()] = target_q_;
  return violation;
}

Joints Arm::delayed_target(Nanoseconds t) const {
  // The target at time k * cycle is history_[k]; the newest one belongs to the end of the cycle under way.
  const Nanoseconds at = std::max<Nanoseconds>(0, t - nanoseconds(config_.delay));
  const std::int64_t k = std::min<std::int64_t>(at / cycle_, planned_);
  const double part = static_cast<double>(at - k * cycle_) / static_cast<double>(cycle_);
  const Joints& a = history_[static_cast<std::size_t>(k) % history_.size()];
  const Joints& b = history_[static_cast<std::size_t>(std::min(k + 1, planned_)) % history_.size()];
  Joints u{};
  for (std::size_t i = 0; i < joint_count; ++i) u[i] = a[i] + part * (b[i] - a[i]);
  return u;
}

void Arm::advance(const Joints& load) {
  if (mode_ == Mode::torque) return advance_under_torque(load);
  const Joints u0 = delayed_target(now_);
  now_ += plant_step;
  const Joints u1 = delayed_target(now_);
  const double h = seconds(plant_step);
  const double tau = lag_ > 1e-6 ? lag_ : 0;
  const double fade = tau > 0 ? std::exp(-h / tau) : 0;
  // The load bends the joints through the same lag, so that stiff contacts stay stable.
  const double bend = tau > 0 ? 1 - fade : 0.5;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const double slope = (u1[i] - u0[i]) / h;
    driven_[i] = u1[i] - slope * tau + (driven_[i] - u0[i] + slope * tau) * fade;
    deflection_[i] += bend * (load[i] / config_.stiffness[i] - integral_[i] - deflection_[i]);
    integral_[i] += h / config_.integral_time * deflection_[i];
    const double q = driven_[i] + deflection_[i];
    dq_[i] = (q - q_[i]) / h;
    q_[i] = q;
  }
}

bool Arm::at_rest() const {
  if (mode_ != Mode::stop || largest(target_dq_) != 0 || largest(dq_) > 1e-4) return false;
  // Motion may still be on its way through the delay.
  for (std::size_t i = 0; i < joint_count; ++i)
    if (std::abs(driven_[i] - target_q_[i]) > 1e-5) return false;
  return true;
}

double Arm::warmer() const {
  return config_.warming * (1 - std::exp(-seconds(now_) / config_.warming_time));
}

void Arm::measure() {
  for (std::size_t i = 0; i < joint_count; ++i) {
    measured_q_[i] = q_[i] + config_.position_noise * random_.normal();
    measured_dq_[i] = dq_[i] + config_.velocity_noise * random_.normal();
    torque_noise_[i] = config_.torque_noise[i] * torque_random_.normal() + config_.torque_bias[i] +
                       seconds(now_) * config_.torque_creep[i];
    const double left = std::max(0.1, 1 - config_.friction_per_kelvin * warmer());
    drives_.viscous[i] = left * config_.drives.viscous[i];
    drives_.coulomb[i] = left * config_.drives.coulomb[i];
  }
  if (mode_ != Mode::torque) {  // means of the cycle
    Joints q{}, dq{}, ddq{};
    for (std::size_t i = 0; i < joint_count; ++i) {
      q[i] = 0.5 * (q_[i] + q_before_[i]);
      dq[i] = (q_[i] - q_before_[i]) / dt_;
      ddq[i] = (dq_[i] - dq_before_[i]) / dt_;
    }
    motor_torque_ = torque_of_motion(q, dq, ddq, config_.bodies, drives_);
    for (std::size_t i = 0; i < joint_count; ++i) {
      // Dry friction turns round over the way; so does its mean.
      const double step = q_[i] - q_before_[i], side = step > 0 ? 1 : -1,
                   way = std::abs(step) / drives_.presliding, rest = side - friction_side_[i];
      const double turned = way > 1e-9 ? (1 - std::exp(-way)) / way : 1;
      friction_side_[i] = side - rest * std::exp(-way);
      motor_torque_[i] += drives_.viscous[i] * dq[i] + drives_.coulomb[i] * (side - rest * turned);
    }
  }
  q_before_ = q_, dq_before_ = dq_;
}

}  // namespace simulated_ur5
