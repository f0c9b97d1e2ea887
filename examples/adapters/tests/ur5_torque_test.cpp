// The UR driver by torque: the simulated arm, with the friction that its controller leaves over, comes to rest at its
// target.
#include <doctest/doctest.h>

#include <cstring>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/control/reactive_control.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/robot/virtual_mass.hpp"
#include "skinctl/tracking/friction_learning.hpp"

using namespace skinctl;
using namespace adapters::ur5;

namespace {

constexpr double degree = 0.017453292519943295;

struct Rest {
  double error = 0, hunting = 0, moved = 0;
  std::string lost;
};

/// Goes 0.3 rad with every joint and rests, in step with the simulation.
Rest rest_under_torque(bool learns, double coulomb_scale) {
  simulated_ur5::Config robot_config;
  std::memset(static_cast<void*>(&robot_config.ports), 0, sizeof robot_config.ports);
  robot_config.controller.series = simulated_ur5::Series::e_series;
  robot_config.controller.powered = true;
  robot_config.speed = 0;
  simulated_ur5::SimulatedUr5 robot(robot_config);
  robot.start();
  DriverConfig config;
  config.rtde_port = robot.ports().rtde;
  config.script_port = robot.ports().secondary;
  config.dashboard_port = robot.ports().dashboard;
  config.interface = Interface::torque;
  config.rate = 500;
  config.real_time = false;
  config.silence = config.give_up = adapters::Timeout(3000);
  config.torque.coulomb.fill(coulomb_scale);
  Driver driver(config);
  driver.connect();

  const ur5::Model model;
  const NoTouch none;
  using Joint = ReactiveJoint<6>;
  using Learning = FrictionLearning<Joint>;
  using K = Quantities<ur5::Model, Learning::needs, double, NoTouch, VirtualMass<6>>;
  // What the rotors add to the links, as the simulated arm has it.
  const JointTorque<6> rotors(robot_config.controller.arm.drives.rotor_inertia),
      most = JointTorque<6>::constant(150);
  const NoToolShape no_tool;
  const VirtualMass<6> added(most, rotors, no_tool);
  JointControlSettings<6> s{.dt = 2ms, .lambda = 60, .K_i1 = 0, .K_i2 = 0, .tb = 0s, .K_c = 8};
  s.target_age = 500ms;
  s.virtual_dynamics.inertia = rotors;
  const double rate = learns ? 300 : 1e-9;
  const Learning law(Joint(s), s, {.rate = rate, .bound = {20, 20, 15, 6, 6, 6}, .dead_zone = 0.05 * degree});

  State<6> state;
  Rest out;
  if (driver.wait(state) != Heard::state) return {.lost = driver.error()};
  const JointPosition<6> home = state.q;
  JointPosition<6> goal = home, low = JointPosition<6>::constant(1e9),
                   high = JointPosition<6>::constant(-1e9);
  for (double& q : goal) q += 0.3;
  auto memory = law.start(K(model, state, 0.002, none, added));
  constexpr int cycles = 3000;
  for (int i = 0; i < cycles; ++i) {
    const K known(model, state, 0.002, none, added);
    if (i % 10 == 0) memory = law.receive(memory, known, {goal, {}, {}}).memory;
    JointCommand<6> command;
    command.torque = law.torque<GravityTerm::left_out>(memory, known);  // the controller holds the weight
    memory = law.advance(memory, known, 0.002, Opposition::none);
    if (!driver.send(command) || driver.wait(state) == Heard::lost) {
      out.lost = driver.error();
      return out;
    }
    for (std::size_t j = 0; j < 6; ++j) {
      out.moved = std::max(out.moved, std::abs(state.q[j] - home[j]));
      if (i < cycles * 7 / 10) continue;
      out.error = std::max(out.error, std::abs(state.q[j] - goal[j]));
      low[j] = std::min(low[j], state.q[j]);
      high[j] = std::max(high[j], state.q[j]);
      out.hunting = std::max(out.hunting, high[j] - low[j]);
    }
  }
  return out;
}

}  // namespace

TEST_CASE("UR driver: by torque the simulated arm rests within 0.1 degree of its target, and stands") {
  // The controller compensates dry friction by the measured speed: not at rest, and at once when a joint slips. Learning
  // takes all of it instead.
  const Rest without = rest_under_torque(false, 0), with = rest_under_torque(true, 0),
             both = rest_under_torque(true, 0.8);
  MESSAGE("error at rest ", without.error / degree, " deg without learning, ", with.error / degree,
          " with it, where a joint still moves by ", with.hunting / degree,
          "; with the controller's 0.8 beside it ", both.error / degree, " and ", both.hunting / degree);
  CHECK(with.lost.empty());
  CHECK(with.moved > 0.25);
  CHECK(without.error > 0.5 * degree);
  CHECK(with.error < 0.1 * degree);
  CHECK(with.hunting < 0.02 * degree);
}
