// SPDX-License-Identifier: BSD-3-Clause
// The plant of tests by joint impedance: links on springs with damping, about positions that are commanded
// with a torque beside them.
#pragma once

#include <array>
#include <cmath>
#include <deque>

#include "skinctl/core/command.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/ldlt.hpp"

namespace skinctl::testing {

/// The true parameters of a robot by joint impedance.
template <std::size_t N>
struct ImpedanceTruth {
  JointTorque<N> stiffness;    ///< stiffness k of the spring at each joint [N m/rad]
  double damping_ratio = 0.7;  ///< damping ratio of the springs with the links' inertia at the start
  JointTorque<N> rotors = {};  ///< inertia of the motors behind their gears [kg m^2]
  double delay = 0;            ///< time from sending a command until the robot takes it [s]
  double period = 0.001;       ///< time in which the robot moves its reference to a new command [s]
};

/// `(M + I) ddq + C dq = k (r - q) + d (dr - dq) + tau + pushed`: the reference r goes to each commanded
/// position within a period, tau is held until the next one, and the robot bears its own weight.
template <RobotModel M>
class ImpedancePlant {
 public:
  static constexpr std::size_t joints = M::joints;
  using Truth = ImpedanceTruth<joints>;

  /// A robot at rest at `q`.
  ImpedancePlant(const M& model, const Truth& truth, const JointPosition<joints>& q)
      : model_(model), truth_(truth), q_(q), reference_(q), target_(q) {
    damp();
  }

  /// Takes over a command after the delay.
  void command(const ImpedanceCommand<joints>& c) {
    under_way_.push_back({time_ + truth_.delay, c.position, c.torque});
  }
  /// Sets other springs from here on, about where the links are; of no stiffness, torques alone move them.
  void hold_by(const JointTorque<joints>& stiffness) {
    truth_.stiffness = stiffness;
    under_way_.clear();
    reference_ = target_ = q_;
    rate_ = {};
    torque_ = {};
    damp();
  }
  /// Whether joint `i` cannot move.
  void hold_fast(std::size_t i, bool fast) { stuck_[i] = fast; }
  /// Sets the joint torque of the world from here on [N m].
  void push(const JointTorque<joints>& torque) { pushed_ = torque; }

  /// Runs for `dt` seconds.
  void run(double dt) {
    const int steps = static_cast<int>(std::ceil(dt / longest_step));
    for (int k = 0; k < steps; ++k) step(dt / steps);
  }

  [[nodiscard]] const JointPosition<joints>& q() const { return q_; }
  [[nodiscard]] const JointVelocity<joints>& dq() const { return dq_; }
  /// The joint positions about which the springs hold [rad].
  [[nodiscard]] const JointPosition<joints>& reference() const { return reference_; }
  /// The motors' torque at the joints, with that for the weight [N m]: what such robots measure.
  [[nodiscard]] JointTorque<joints> motor_torque() const {
    return force_ + inverse_dynamics(model_, q_, JointVelocity<joints>{}, JointAcceleration<joints>{});
  }

 private:
  static constexpr double longest_step = 0.25e-3;
  static constexpr double stuck_mass = 1e9;  ///< inertia of a joint that cannot move [kg m^2]
  struct Command {
    double time;
    JointPosition<joints> position;
    JointTorque<joints> torque;
  };

  void damp() {
    const auto mass = mass_matrix(model_, q_);
    for (std::size_t i = 0; i < joints; ++i)
      damping_[i] =
          2 * truth_.damping_ratio * std::sqrt(truth_.stiffness[i] * (mass(i, i) + truth_.rotors[i]));
  }
  /// Semi-implicit in velocity, spring and damping: stable for light links too.
  void step(double h) {
    time_ += h;
    for (; !under_way_.empty() && under_way_.front().time <= time_ + 1e-9; under_way_.pop_front()) {
      target_ = under_way_.front().position;
      torque_ = under_way_.front().torque;
      for (std::size_t i = 0; i < joints; ++i) rate_[i] = (target_[i] - reference_[i]) / truth_.period;
    }
    for (std::size_t i = 0; i < joints; ++i) {
      const double next = reference_[i] + h * rate_[i];
      if ((target_[i] - next) * rate_[i] <= 0) rate_[i] = (target_[i] - reference_[i]) / h;
      reference_[i] += h * rate_[i];
    }
    const JointAngles<M, double> angles(model_, q_);
    auto mass = mass_matrix(model_, angles);
    const auto coriolis = coriolis_torque(model_, angles, dq_);
    JointTorque<joints> net;
    for (std::size_t i = 0; i < joints; ++i) {
      const double k = truth_.stiffness[i], d = damping_[i];
      mass(i, i) += truth_.rotors[i] + h * d + h * h * k;
      force_[i] = k * (reference_[i] - q_[i]) + d * (rate_[i] - dq_[i]) + torque_[i];
      net[i] = force_[i] - h * k * dq_[i] + pushed_[i] - coriolis[i];
      if (stuck_[i]) mass(i, i) += stuck_mass, dq_[i] = net[i] = 0;
    }
    JointAcceleration<joints> ddq;
    math::Ldlt<joints, double>(mass.data).solve(net.data, ddq.data);
    dq_ = integrate(dq_, ddq, h);
    q_ = integrate(q_, dq_, h);
  }

  M model_;
  Truth truth_;
  JointPosition<joints> q_, reference_, target_;
  JointVelocity<joints> dq_, rate_;
  JointTorque<joints> torque_, pushed_, force_, damping_;
  std::array<bool, joints> stuck_{};
  std::deque<Command> under_way_;
  double time_ = 0;
};

}  // namespace skinctl::testing
