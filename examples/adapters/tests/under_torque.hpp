// A UR5 by direct torque in step with its simulation: goes to rest at a target, or after targets that come in
// steps.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/reactive_control.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/robot/virtual_mass.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tracking/friction_learning.hpp"

namespace under_torque {

using namespace skinctl;

inline constexpr double degree = 0.017453292519943295;

/// The arm with the friction that its controller leaves over, and what a law needs to know of it.
class Arm {
 public:
  /// @param coulomb_scale  share of dry friction that the controller compensates.
  explicit Arm(double coulomb_scale)
      : robot_(with_any_ports()), driver_(driver_config(robot_, coulomb_scale)) {}

  using Known = Quantities<ur5::Model, Needs{.mass = true}, double, NoTouch, RealMass<6>>;
  [[nodiscard]] Known known() const {
    return Known(model_, state, 0.002, none_, RealMass<6>(limits_, motors));
  }
  bool connect() {
    driver_.connect();
    return driver_.wait(state) == Heard::state;
  }
  /// Sends the torque and waits for the next state.
  bool step(const JointTorque<6>& torque) {
    TorqueCommand<6> command;
    command.torque = torque;
    return driver_.send(command) && driver_.wait(state) != Heard::lost;
  }
  [[nodiscard]] const std::string& error() const { return driver_.error(); }

  State<6> state;
  /// At the joints, as the simulated arm has it.
  const JointTorque<6> motors{simulated_ur5::JointDrives{}.rotor_inertia};

 private:
  static simulated_ur5::Config with_any_ports() {
    simulated_ur5::Config c;
    c.ports = {0, 0, 0, 0, 0};
    c.controller.series = simulated_ur5::Series::e_series;
    c.controller.powered = true;
    c.speed = 0;
    return c;
  }
  static adapters::ur5::DriverConfig driver_config(simulated_ur5::SimulatedUr5& robot, double coulomb_scale) {
    robot.start();
    adapters::ur5::DriverConfig c;
    c.rtde_port = robot.ports().rtde;
    c.script_port = robot.ports().secondary;
    c.dashboard_port = robot.ports().dashboard;
    c.interface = Interface::torque;
    c.rate = 500;
    c.real_time = false;
    c.silence = c.give_up = adapters::Timeout(3000);
    c.torque.coulomb.fill(coulomb_scale);
    return c;
  }

  simulated_ur5::SimulatedUr5 robot_;
  adapters::ur5::Driver driver_;
  ur5::Model model_;
  NoTouch none_;
  JointLimits<6> limits_ = limits_of<ur5::Description>(15.0);
};

inline JointControlSettings<6> settings(const Arm& arm) {
  JointControlSettings<6> s{.dt = 2ms, .lambda = 60, .K_i1 = 0, .K_i2 = 0, .tb = 0s, .K_c = 8};
  s.target_age = 500ms;
  s.virtual_dynamics.inertia = arm.motors;
  return s;
}
/// All of the friction, whatever share of it the controller takes.
inline FrictionLearningSettings<6> learning(bool learns) {
  const JointTorque<6> most{20, 20, 15, 6, 6, 6};
  return {.rate = 900, .bound = learns ? most : JointTorque<6>{}, .dead_zone = 0.05 * degree};
}

struct Rest {
  double error = 0;    ///< of the farthest joint in the last 2.4 s of 8 [rad]
  double hunting = 0;  ///< its motion in that time [rad]
  double moved = 0;    ///< from the start [rad]
  std::string lost;
};

/// Goes 0.3 rad with every joint and rests.
inline Rest rest(bool learns, double coulomb_scale) {
  Arm arm(coulomb_scale);
  Rest out;
  if (!arm.connect()) return {.lost = arm.error()};
  using Joint = ReactiveJoint<6>;
  const auto s = settings(arm);
  const FrictionLearning<Joint> law(Joint(s), s, learning(learns));
  const JointPosition<6> home = arm.state.q;
  JointPosition<6> goal = home, low = JointPosition<6>::constant(1e9),
                   high = JointPosition<6>::constant(-1e9);
  for (double& q : goal) q += 0.3;
  auto memory = law.start(arm.known());
  constexpr int cycles = 4000;
  for (int i = 0; i < cycles; ++i) {
    const auto known = arm.known();
    if (i % 10 == 0) memory = law.receive(memory, known, {goal, {}, {}}).memory;
    const auto torque =
        law.template torque<GravityTerm::left_out>(memory, known);  // the controller holds the weight
    memory = law.advance(memory, known, 0.002, Opposition::none);
    if (!arm.step(torque)) return {.lost = arm.error()};
    for (std::size_t j = 0; j < 6; ++j) {
      out.moved = std::max(out.moved, std::abs(arm.state.q[j] - home[j]));
      if (i < cycles * 7 / 10) continue;
      out.error = std::max(out.error, std::abs(arm.state.q[j] - goal[j]));
      low[j] = std::min(low[j], arm.state.q[j]);
      high[j] = std::max(high[j], arm.state.q[j]);
      out.hunting = std::max(out.hunting, high[j] - low[j]);
    }
  }
  return out;
}

struct Following {
  double jerk = 0;         ///< largest, of the law's reference from cycle to cycle [rad/s^3]
  double torque_step = 0;  ///< largest change of a joint's torque from cycle to cycle [N m]
  double error = 0;  ///< root of the mean square, of all joints against the motion that was sampled [rad]
  std::string lost;
};

/// Follows 0.2 rad at 0.25 Hz of which a position comes every 20 ms, for 8 s. `Tracker`: what makes a
/// reference of it.
template <class Tracker>
Following follow_steps(double coulomb_scale) {
  Arm arm(coulomb_scale);
  Following out;
  if (!arm.connect()) return {.lost = arm.error()};
  auto s = settings(arm);
  s.target_age = 100ms;
  const FrictionLearning<Tracker> law(Tracker(s), s, learning(true));
  const JointPosition<6> home = arm.state.q;
  auto memory = law.start(arm.known());
  JointAcceleration<6> last_reference;
  JointTorque<6> last_torque;
  double squares = 0;
  int counted = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto known = arm.known();
    const double t = 0.002 * i;
    JointPosition<6> motion = home;
    for (double& q : motion) q += 0.1 * (1 - std::cos(2 * std::numbers::pi * 0.25 * t));
    if (i % 10 == 0) memory = law.follow(memory, known, {motion, {}, {}}).memory;
    const auto torque = law.template torque<GravityTerm::left_out>(memory, known);
    const auto reference = law.reference(memory);
    if (i > 5)
      for (std::size_t j = 0; j < 6; ++j) {
        out.jerk = std::max(out.jerk, std::abs(reference.ddq_d[j] - last_reference[j]) / 0.002);
        out.torque_step = std::max(out.torque_step, std::abs(torque[j] - last_torque[j]));
        squares += (arm.state.q[j] - motion[j]) * (arm.state.q[j] - motion[j]);
        ++counted;
      }
    last_reference = reference.ddq_d;
    last_torque = torque;
    memory = law.advance(memory, known, 0.002, Opposition::none);
    if (!arm.step(torque)) return {.lost = arm.error()};
  }
  out.error = std::sqrt(squares / counted);
  return out;
}

}  // namespace under_torque
