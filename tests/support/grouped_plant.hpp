// A robot whose joints have several interfaces: stiff ones that follow commands, and driven ones that move as
// the equations of motion say, on an arm that accelerates.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/joint_subset.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/math/ldlt.hpp"
#include "tests/support/simulated_joints.hpp"

namespace skinctl::testing {

/// The joints of `ByVelocity` and the rest follow velocities and positions after a delay and a lag, whatever
/// pushes on them. Those of `ByTorque` obey `M_dd ddq_d = tau_d + push_d - (C dq + G)_d - M_ds ddq_s`.
template <RobotModel M, LinkMask ByTorque, LinkMask ByVelocity>
class GroupedPlant {
 public:
  static constexpr std::size_t joints = M::joints;
  using Driven = JointSubset<joints, ByTorque>;

  /// @param delay  of the joints by position and velocity [s].
  /// @param lag    of those by position [s]; without one they would move in steps.
  GroupedPlant(const M& model, const JointPosition<joints>& q, double lag, double delay = 0)
      : model_(model),
        positions_(SimulatedJoints<joints>::Kind::position, delay, lag, row(q)),
        velocities_(SimulatedJoints<joints>::Kind::velocity, delay, 0, row(q)),
        q_(q) {}

  /// Takes over a command at the present time.
  void command(const JointCommand<joints>& c) {
    positions_.command(time_, row(c.position));
    velocities_.command(time_, row(c.velocity));
    torque_ = c.torque;
  }

  /// Runs for `dt` seconds in `steps` parts under the torque `push(q, dq)` on the driven joints.
  template <class Push>
  void run(double dt, int steps, const Push& push) {
    const double h = dt / steps;
    for (int k = 0; k < steps; ++k) {
      time_ += h;
      positions_.advance(time_);
      velocities_.advance(time_);
      JointAcceleration<joints> ddq;
      JointPosition<joints> next = q_;
      JointVelocity<joints> after = dq_;
      for (std::size_t i = 0; i < joints; ++i) {
        if ((ByTorque >> i) & 1u) continue;
        const auto& of = ((ByVelocity >> i) & 1u) ? velocities_ : positions_;
        next[i] = of.q()[i];
        // The mean velocity: that of a position without lag would come in steps.
        after[i] = (next[i] - q_[i]) / h;
        ddq[i] = (after[i] - dq_[i]) / h;
      }
      if constexpr (Driven::count > 0) {
        // Drift, kick, drift: the displacement is that of the mean velocity, so that the work of a held
        // torque is exact, and a contact neither gains nor loses.
        JointPosition<joints> q = q_;
        for (const std::size_t i : Driven::index) q[i] += 0.5 * h * dq_[i];
        const JointAngles<M, double> angles(model_, q);
        const auto mass = mass_matrix(model_, angles);
        const auto bias = bias_torque(model_, angles, dq_);
        const JointTorque<joints> pushed = push(q, dq_);
        JointTorque<Driven::count> net;
        MassMatrix<Driven::count> own;
        for (std::size_t i = 0; i < Driven::count; ++i) {
          const std::size_t I = Driven::index[i];
          net[i] = torque_[I] + pushed[I] - bias[I];
          for (const std::size_t j : Driven::Others::index) net[i] -= mass(I, j) * ddq[j];
          for (std::size_t j = 0; j < Driven::count; ++j) own(i, j) = mass(I, Driven::index[j]);
        }
        JointAcceleration<Driven::count> given;
        math::Ldlt<Driven::count, double>(own.data).solve(net.data, given.data);
        for (std::size_t i = 0; i < Driven::count; ++i) {
          const std::size_t I = Driven::index[i];
          after[I] = dq_[I] + h * given[i];
          next[I] = q[I] + 0.5 * h * after[I];
        }
      }
      q_ = next;
      dq_ = after;
    }
  }

  /// Joint `i`, by position or velocity, cannot move any more.
  void hold_fast(std::size_t i) {
    positions_.hold_fast(i, true);
    velocities_.hold_fast(i, true);
  }

  [[nodiscard]] const JointPosition<joints>& q() const { return q_; }
  [[nodiscard]] const JointVelocity<joints>& dq() const { return dq_; }

 private:
  template <class V>
  static typename SimulatedJoints<joints>::Row row(const V& v) {
    typename SimulatedJoints<joints>::Row r{};
    for (std::size_t i = 0; i < joints; ++i) r[i] = v[i];
    return r;
  }

  M model_;
  SimulatedJoints<joints> positions_, velocities_;
  JointPosition<joints> q_;
  JointVelocity<joints> dq_;
  JointTorque<joints> torque_;
  double time_ = 0;
};

}  // namespace skinctl::testing
