#include "examples/calibrate_skin/arm.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/support/job.hpp"
#include "skinctl/calibration/link_inertia.hpp"

namespace calibrate_skin {

using namespace skinctl;

void weigh(simulated_ur5::ArmConfig& arm, const RobotMasses& masses) {
  simulated_ur5::Bodies::Links links;
  const auto maker = simulated_ur5::makers_bodies();
  for (std::size_t i = 0; i < 6; ++i) links[i] = with_inertia(maker.link(i), masses.bodies[i].data());
  arm.bodies = simulated_ur5::Bodies(links);
  arm.drives.viscous = masses.viscous, arm.drives.coulomb = masses.coulomb,
  arm.drives.rotor_inertia = masses.rotor;
}

struct Arm::Parts {
  ArmOptions options;
  std::unique_ptr<simulated_ur5::SimulatedUr5> simulated;
  std::unique_ptr<adapters::ur5::Driver> driver;
  State<6> state;
  std::optional<JointAngles6> told;  ///< last command

  Parts(const ArmOptions& o, const RobotMasses& weight) : options(o) {
    adapters::ur5::DriverConfig config;
    config.motors = adapters::ur5::MotorOutput::current;
    if (o.host.empty()) {
      simulated_ur5::Config robot;
      robot.controller.series = simulated_ur5::Series::cb3;
      robot.controller.powered = true;
      robot.controller.arm.home = {0.2, -1.6, 0.9, -0.9, -1.4, 0.3};  // `home` of world.hpp
      robot.ports = {0, 0, 0, 0, 0};
      robot.speed = 0;
      robot.patience =
          2;  // a computer that is busy elsewhere is no robot that is told nothing; less than its client waits
      weigh(robot.controller.arm, weight);
      simulated = std::make_unique<simulated_ur5::SimulatedUr5>(std::move(robot));
      simulated->start();
      const auto ports = simulated->ports();
      config.rtde_port = ports.rtde, config.script_port = ports.secondary;
      config.dashboard_port = ports.dashboard;
      config.real_time = false;
      config.silence = config.give_up = adapters::Timeout{3000};
    } else {
      config.host = o.host;
      if (o.rtde_port != 0) config.rtde_port = o.rtde_port;
      if (o.script_port != 0) config.script_port = o.script_port;
      if (o.dashboard_port != 0) config.dashboard_port = o.dashboard_port;
      if (o.own_clock) config.real_time = false, config.silence = config.give_up = adapters::Timeout{3000};
    }
    driver = std::make_unique<adapters::ur5::Driver>(config);
    driver->connect();
    hear();
  }
  ~Parts() {
    if (driver) driver->stop();
  }
  void hear() {
    if (options.stop != nullptr && *options.stop) {
      driver->stop();
      throw Interrupted{};
    }
    for (;;) {
      const Heard heard = driver->wait(state);
      if (heard == Heard::lost) throw std::runtime_error("the robot was lost: " + driver->error());
      if (heard == Heard::state) {
        options.each_cycle(state.time);
        return;
      }
    }
  }
  void tell(const std::array<double, 6>& q) {
    PositionCommand<6> command;
    command.valid = true;
    command.time = state.time;
    command.position = JointPosition<6>(q);
    if (!driver->send(command)) throw std::runtime_error("the robot takes no commands: " + driver->error());
    told = q;
  }
  [[nodiscard]] JointAngles6 measured() const {
    JointAngles6 q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = state.q[i];
    return q;
  }
  [[nodiscard]] JointAngles6 truth() { return simulated ? simulated->snapshot().true_q : measured(); }
};

Arm::Arm(const ArmOptions& options, const RobotMasses& simulated)
    : parts_(std::make_unique<Parts>(options, simulated)) {}
Arm::~Arm() = default;

JointAngles6 Arm::here() {
  return parts_->measured();
}

Arm::Stand Arm::go(const JointAngles6& to, double speed) {
  Parts& p = *parts_;
  const JointAngles6 from = p.measured();
  double way = 0;
  for (std::size_t i = 0; i < 6; ++i) way = std::max(way, std::abs(to[i] - from[i]));
  const double duration = std::max(0.2, 1.875 * way / speed);
  const Nanoseconds begin = p.state.time;
  // The drives lag behind by less than a tenth of a second.
  for (double t = 0; t < duration + 0.6; t = seconds<double>(p.state.time - begin)) {
    const double x = std::min(1.0, t / duration), s = x * x * x * (10 + x * (6 * x - 15));
    JointAngles6 q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = from[i] + s * (to[i] - from[i]);
    p.tell(q);
    p.hear();
  }
  const Stand stand{p.measured(), p.truth()};
  for (std::size_t i = 0; i < 6; ++i)
    if (!(std::abs(stand.measured[i] - to[i]) < 0.01))
      throw std::runtime_error("joint " + std::to_string(i) + " does not go where it is told to");
  return stand;
}

void Arm::stay(double duration) {
  Parts& p = *parts_;
  // Not where it is: an arm that sags would sag each time.
  const JointAngles6 q = p.told.value_or(p.measured());
  const Nanoseconds begin = p.state.time;
  while (seconds<double>(p.state.time - begin) < duration) p.tell(q), p.hear();
}

Ride Arm::follow(const std::function<JointPoint(double)>& path, double duration) {
  Parts& p = *parts_;
  constexpr double rest = 1;
  std::vector<double> time;
  std::vector<JointAngles6> measured, torque, truth;
  const Nanoseconds begin = p.state.time;
  examples::job::Progress progress(p.options.quiet);
  for (double t = 0; t < duration + 2 * rest; t = seconds<double>(p.state.time - begin)) {
    time.push_back(t);
    measured.push_back(p.measured());
    truth.push_back(p.truth());
    torque.push_back(p.driver->report().motors);
    for (std::size_t i = 0; i < 6; ++i) torque.back()[i] *= p.options.torque_per_ampere[i];
    if (progress.due(t)) progress.show("  %4.0f of %.0f s", t, duration + 2 * rest);
    const Eigen::VectorXd at = path(std::clamp(t - rest, 0.0, duration)).q;
    JointAngles6 q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = at(Eigen::Index(i));
    p.tell(q);
    p.hear();
  }
  progress.clear();
  const auto table = [&](const std::vector<JointAngles6>& rows) {
    JointRecording out{time, Eigen::MatrixXd(Eigen::Index(rows.size()), 6)};
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t i = 0; i < 6; ++i) out.q(Eigen::Index(k), Eigen::Index(i)) = rows[k][i];
    return out;
  };
  return {begin, table(measured), table(torque).q, table(truth)};
}

}  // namespace calibrate_skin
