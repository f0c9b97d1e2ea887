// SPDX-License-Identifier: BSD-3-Clause
// Joints by position or velocity that are not as declared: a delay that jitters, two lags, a servo that gives
// way under load, friction, encoders that are off. Standard library only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>

namespace skinctl::testing {

/// The true parameters of a robot; each default is the ideal joint.
template <std::size_t N>
struct JointTruth {
  using Row = std::array<double, N>;
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  static constexpr Row all(double x) {
    Row r{};
    for (double& e : r) e = x;
    return r;
  }

  // The way of a command.
  double delay = 0;             ///< time from sending a command until the robot takes it [s]
  double delay_jitter = 0;      ///< largest deviation of a command's delay, either way [s]; the order is kept
  double lookahead = 0;         ///< time constant of a first lag, as of servoj [s]
  double lag = 0;               ///< time constant of the second lag [s]
  double max_speed = infinite;  ///< largest speed of the reference [rad/s]

  // The servo, `I ddq = I ddr + k (r - q) + d (dr - dq) + k/T_i integral(r - q) + external - friction`, with
  // `d = 2 damping_ratio sqrt(k I)`: a constant torque moves the joint by `external / k` from its reference
  // r. I ddr takes half of the torque limit at most: of a reference that steps (a position that is held, with
  // next to no lag) the servo would otherwise lose the kick to its limit, keep the braking after it, and go
  // backwards.
  Row stiffness = all(infinite);     ///< stiffness k [N m/rad]; infinite: the joint is at its reference
  double integral_time = infinite;   ///< integral time T_i of the servo [s], > I/d or it oscillates by itself
  Row inertia = all(1);              ///< inertia I of each joint [kg m^2]
  double damping_ratio = 1;          ///< damping ratio of k and I
  Row torque_limit = all(infinite);  ///< largest torque of the servo [N m]; beyond it the joint gives way
  Row coulomb = all(0);              ///< friction of a joint that moves [N m]; none with infinite k
  Row stiction = all(0);             ///< friction of a joint that rests [N m], at least `coulomb`

  // The encoders.
  Row gap = all(0);         ///< measured less true position [rad]; a wrap is 2 pi
  double resolution = 0;    ///< step of the encoders [rad]
  double noise = 0;         ///< standard deviation of the encoders [rad]
  double skipped = 0;       ///< share of the measurements that do not come: the one before is repeated
  double stamp_jitter = 0;  ///< largest error of a stamp, either way [s]
};

template <std::size_t N>
class UndeclaredJoints {
 public:
  using Row = std::array<double, N>;
  enum class Kind { position, velocity };
  struct Measured {
    double time;  ///< stamp [s]
    Row q, dq;
    bool fresh;  ///< the measurement is new, not a repetition
  };

  /// Joints at rest at the true positions `q` [rad]; the same seed gives the same jitter and noise.
  UndeclaredJoints(Kind kind, const JointTruth<N>& truth, const Row& q, std::uint64_t seed = 1)
      : kind_(kind), truth_(truth), q_(q), reference_(q), random_(seed) {
    if (kind == Kind::position) target_ = first_ = second_ = q;
    for (std::size_t i = 0; i < N; ++i) {
      rigid_ = rigid_ && !(truth.stiffness[i] < truth.infinite);
      damping_[i] = 2 * truth.damping_ratio * std::sqrt(truth.stiffness[i] * truth.inertia[i]);
    }
    last_ = sample();
  }

  /// Holds this command from `t + delay` on.
  void command(double t, const Row& value) {
    double at = t + truth_.delay + truth_.delay_jitter * (2 * uniform() - 1);
    if (!under_way_.empty()) at = std::max(at, under_way_.back().time);
    under_way_.push_back({std::max(at, time_), value});
  }
  /// Sets the torques on the joints from here on [N m]: contacts, and load of which the robot does not know.
  void external(const Row& torque) { external_ = torque; }

  /// Runs to time `t` [s].
  void advance(double t) {
    while (!under_way_.empty() && under_way_.front().time <= t) {
      run(under_way_.front().time);
      target_ = under_way_.front().value;
      under_way_.pop_front();
    }
    run(t);
  }

  /// Holds joint `i` fast, or lets it go.
  void hold_fast(std::size_t i, bool fast) { stuck_[i] = fast; }
  /// Moves joint `i` by hand by `by` [rad]: by position it goes back with its lags, by velocity it stays.
  void displace(std::size_t i, double by) {
    q_[i] += by;
    reference_[i] += by;
    if (kind_ == Kind::position) second_[i] += by;
  }
  /// Sets the speed slider, 0 to 1: velocities, `max_speed` and the clock of the lags are scaled by it.
  void slider(double share) { slider_ = share; }

  /// The robot's report at its present time, once per call.
  const Measured& measured() {
    const bool skip = truth_.skipped > 0 && uniform() < truth_.skipped;
    if (!skip) last_ = sample();
    last_.fresh = !skip;
    return last_;
  }

  /// The true parameters, which may change.
  JointTruth<N>& truth() { return truth_; }

  const Row& q() const { return q_; }  ///< true joint positions [rad]
  const Row& dq() const { return dq_; }
  const Row& reference() const { return reference_; }  ///< positions that the servo follows [rad]
  double time() const { return time_; }

 private:
  struct Command {
    double time;
    Row value;
  };
  static constexpr double longest_step = 0.5e-3;  // of the servo [s]

  double uniform() {  // splitmix64
    std::uint64_t z = (random_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double normal() {
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += uniform();
    return sum;
  }
  Measured sample() {
    Measured m{time_, q_, dq_, true};
    if (truth_.stamp_jitter > 0) m.time += truth_.stamp_jitter * (2 * uniform() - 1);
    for (std::size_t i = 0; i < N; ++i) {
      m.q[i] += truth_.gap[i];
      if (truth_.noise > 0) m.q[i] += truth_.noise * normal();
      if (truth_.resolution > 0) m.q[i] = truth_.resolution * std::round(m.q[i] / truth_.resolution);
    }
    return m;
  }

  void run(double t) {
    const double span = t - time_;
    if (!(span > 0)) return;
    const double steps = rigid_ ? 1 : std::ceil(span / longest_step);
    const double dt = span / steps;
    const double clock = kind_ == Kind::position ? dt * slider_ : dt;
    const double a = truth_.lookahead, b = truth_.lag;
    const double decay_a = a > 0 ? std::exp(-clock / a) : 0, decay_b = b > 0 ? std::exp(-clock / b) : 0;
    // Of two lags in a row: what the first has left to do after `clock`, as the second sees it.
    const double both = a > 0 && b > 0 ? (std::abs(a - b) > 1e-6 * a ? (decay_a - decay_b) * a / (a - b)
                                                                     : clock / b * decay_b)
                                       : (a > 0 ? decay_a : 0);
    for (int k = 0; k < static_cast<int>(steps); ++k)
      for (std::size_t i = 0; i < N; ++i) {
        const double before = reference_[i];
        follow(i, dt, clock, decay_a, decay_b, both);
        servo(i, dt, before);
      }
    time_ = t;
  }

  /// Moves the reference on by `dt`; exact for a constant target.
  void follow(std::size_t i, double dt, double clock, double decay_a, double decay_b, double both) {
    const double c = kind_ == Kind::position ? target_[i] : target_[i] * slider_;
    const double first = first_[i] - c, second = second_[i] - c, before = reference_[i];
    first_[i] = c + first * decay_a;
    second_[i] = c + first * both + second * decay_b;
    if (truth_.lag <= 0) second_[i] = first_[i];
    if (kind_ == Kind::position) {
      reference_[i] = second_[i];
      rate_[i] = truth_.lag > 0         ? (first_[i] - second_[i]) / truth_.lag * slider_
                 : truth_.lookahead > 0 ? (c - first_[i]) / truth_.lookahead * slider_
                                        : (reference_[i] - before) / dt;
    } else {
      reference_[i] +=
          c * clock + truth_.lookahead * first * (1 - decay_a) + truth_.lag * (second + c - second_[i]);
      rate_[i] = second_[i];
    }
    const double most = truth_.max_speed * slider_;
    if (std::abs(reference_[i] - before) <= most * dt) return;
    rate_[i] = std::copysign(most, reference_[i] - before);
    reference_[i] = before + rate_[i] * dt;
    if (kind_ == Kind::position) second_[i] = reference_[i];
  }

  /// Moves the joint on by `dt`, implicit in its servo and its friction: stable for any stiffness and step.
  void servo(std::size_t i, double dt, double before) {
    const double k = truth_.stiffness[i], limit = truth_.torque_limit[i];
    const bool stiff = !(k < truth_.infinite);
    const double rate = fed_[i], faster = 0.5 * limit / truth_.inertia[i] * dt;
    fed_[i] += std::clamp(rate_[i] - rate, -faster, faster);
    if (stuck_[i]) {
      dq_[i] = 0;
      // Its servo pushes with no more than it has; a stiff joint's lags begin where it stands.
      const double most = stiff ? 0 : limit / k;
      reference_[i] = std::clamp(reference_[i], q_[i] - most, q_[i] + most);
      if (kind_ == Kind::position && stiff) second_[i] = reference_[i];
      return;
    }
    if (stiff) {
      q_[i] += reference_[i] - before;
      dq_[i] = rate_[i];
      return;
    }
    const double Ix = truth_.inertia[i], d = damping_[i], v0 = dq_[i];
    const double ki = truth_.integral_time < truth_.infinite ? k / truth_.integral_time : 0;
    const double gap = reference_[i] - q_[i];
    // The reference's motion within the step as its mean, so that a reference that jumps is followed.
    const double mean = (reference_[i] - before) / dt;
    const double rest = Ix + dt * d + dt * dt * (k + dt * ki);
    const double push = Ix * (fed_[i] - rate) + dt * (k * gap + d * mean + ki * (integral_[i] + dt * gap));
    double v = (Ix * v0 + push + dt * external_[i]) / rest;
    const double servo_torque = Ix * (v - v0) / dt - external_[i];  // what this takes
    const bool weak = std::abs(servo_torque) > limit;
    double mass = rest;
    if (weak) {
      mass = Ix;
      v = v0 + dt / Ix * (std::copysign(limit, servo_torque) + external_[i]);
    } else {
      integral_[i] += dt * (gap - dt * v);
    }
    const double friction = v0 == 0 ? std::max(truth_.coulomb[i], truth_.stiction[i]) : truth_.coulomb[i];
    const double most = dt * friction / mass;
    v = std::abs(v) <= most ? 0 : v - std::copysign(dt * truth_.coulomb[i] / mass, v);
    q_[i] += dt * v;
    dq_[i] = v;
    // By velocity the reference does not run away from a joint that cannot follow.
    if (kind_ == Kind::velocity)
      reference_[i] = std::clamp(reference_[i], q_[i] - limit / k, q_[i] + limit / k);
  }

  Kind kind_;
  JointTruth<N> truth_;
  Row q_, dq_{}, reference_, rate_{}, fed_{}, target_{}, first_{}, second_{}, external_{}, integral_{},
      damping_{};
  std::array<bool, N> stuck_{};
  bool rigid_ = true;
  double slider_ = 1, time_ = 0;
  std::uint64_t random_;
  Measured last_;
  std::deque<Command> under_way_;
};

}  // namespace skinctl::testing
