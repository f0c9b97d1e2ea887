// A simulated UR5 under direct torque: how well it follows by one model and by another.
#include <cmath>
#include <stdexcept>
#include <utility>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/calibrate_skin/masses.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/robots/ur5.hpp"

namespace calibrate_skin {

using namespace skinctl;

double following_error(const RobotMasses& truth, const FoundModel* model, const RobotMasses& friction) {
  simulated_ur5::Config robot;
  robot.ports = {0, 0, 0, 0, 0};
  robot.controller.series = simulated_ur5::Series::e_series;
  robot.controller.powered = true;
  robot.controller.arm.home = home;
  robot.speed = 0;
  robot.patience =
      2;  // a computer that is busy elsewhere is no robot that is told nothing; less than its client waits
  weigh(robot.controller.arm, truth);
  simulated_ur5::SimulatedUr5 simulated(std::move(robot));
  simulated.start();
  adapters::ur5::DriverConfig config;
  config.rtde_port = simulated.ports().rtde, config.script_port = simulated.ports().secondary;
  config.dashboard_port = simulated.ports().dashboard;
  config.interface = Interface::torque;
  config.rate = 500;
  config.real_time = false;
  config.silence = config.give_up = adapters::Timeout{3000};
  config.torque.friction = false;  // ours
  adapters::ur5::Driver driver(config);
  driver.connect();
  State<6> state;
  const auto hear = [&] {
    for (Heard heard{}; (heard = driver.wait(state)) != Heard::state;)
      if (heard == Heard::lost) throw std::runtime_error("the robot was lost: " + driver.error());
  };
  hear();

  const PlannedMotion motion = masses_motion(2);
  constexpr JointAngles6 stiffness = {600, 600, 300, 40, 40, 15};  // [N m/rad]
  constexpr double damping = 0.12;                                 // of it [s]
  double squares = 0, count = 0;
  const Nanoseconds begin = state.time;
  for (double t = 0; t < 10; t = seconds<double>(state.time - begin)) {
    const auto [q, dq, ddq] = JointState6(motion.path(t));
    // The controller adds the weight by the maker's numbers.
    auto tau =
        (model != nullptr ? yr_theta(*model, q, dq, dq, ddq) : yr_theta(ur5::Model{}, q, dq, dq, ddq)) -
        gravity_torque(ur5::Model{}, state.q);
    for (std::size_t i = 0; i < 6; ++i) {
      const double e = q[i] - state.q[i], de = dq[i] - state.dq[i];
      tau[i] += friction.rotor[i] * ddq[i] + friction.viscous[i] * dq[i] +
                friction.coulomb[i] * std::tanh(dq[i] / 0.02) + stiffness[i] * (e + damping * de);
      if (t > 1) squares += e * e, count += 1;
    }
    TorqueCommand<6> command;
    command.torque = tau;
    if (!driver.send(command)) throw std::runtime_error("the robot takes no torques: " + driver.error());
    hear();
  }
  driver.stop();
  return std::sqrt(squares / count);
}

}  // namespace calibrate_skin
