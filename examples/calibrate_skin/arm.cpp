#include "examples/calibrate_skin/arm.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/calibrate_skin/drive.hpp"
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
  std::unique_ptr<Drive> drive;
  Nanoseconds now{};
  std::optional<JointAngles> told;  ///< last command

  Parts(const ArmOptions& o, const RobotMasses& weight) : options(o) {
    drive = o.protocol == "ur" ? ur_drive(weight) : clocked_drive(o);
    hear();
  }
  ~Parts() {
    if (drive) drive->stop();
  }
  std::unique_ptr<Drive> ur_drive(const RobotMasses& weight) {
    const ArmOptions& o = options;
    require(o.robot.joints() == 6, "joints of the robot", double(o.robot.joints()), "6, as a UR has");
    adapters::ur5::DriverConfig config;
    config.motors = adapters::ur5::MotorOutput::current;
    if (o.host.empty()) {
      simulated_ur5::Config robot;
      robot.controller.series = simulated_ur5::Series::cb3;
      robot.controller.powered = true;
      std::copy(o.robot.home.begin(), o.robot.home.end(), robot.controller.arm.home.begin());
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
    return std::make_unique<DriveOf<adapters::ur5::Driver, 6>>(config);
  }
  void hear() {
    if (options.stop != nullptr && *options.stop) {
      drive->stop();
      throw Interrupted{};
    }
    now = drive->hear();
    options.each_cycle(now);
  }
  void tell(const JointAngles& q) {
    drive->tell(q);
    told = q;
  }
  [[nodiscard]] JointAngles truth() const {
    if (!simulated) return drive->measured();
    const auto q = simulated->snapshot().true_q;
    return {q.begin(), q.end()};
  }
};

Arm::Arm(const ArmOptions& options, const RobotMasses& simulated)
    : parts_(std::make_unique<Parts>(options, simulated)) {}
Arm::~Arm() = default;

JointAngles Arm::here() {
  return parts_->drive->measured();
}

Arm::Stand Arm::go(const JointAngles& to, double speed) {
  Parts& p = *parts_;
  const JointAngles from = p.drive->start();
  double way = 0;
  for (std::size_t i = 0; i < to.size(); ++i) way = std::max(way, std::abs(to[i] - from[i]));
  // Peaks of the quintic: 1.875, 5.77 and 60 of way over powers of the duration.
  const double duration =
      std::max({0.2, 1.875 * way / speed, std::sqrt(5.77 * way / p.options.robot.acceleration),
                std::cbrt(60 * way / p.options.robot.jerk)});
  const Nanoseconds begin = p.now;
  // The drives lag behind by less than a tenth of a second.
  for (double t = 0; t < duration + 0.6; t = seconds<double>(p.now - begin)) {
    const double x = std::min(1.0, t / duration), s = x * x * x * (10 + x * (6 * x - 15));
    JointAngles q = from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += s * (to[i] - from[i]);
    p.tell(q);
    p.hear();
  }
  const Stand stand{p.drive->measured(), p.truth()};
  for (std::size_t i = 0; i < to.size(); ++i)
    if (!(std::abs(stand.measured[i] - to[i]) < 0.01))
      throw std::runtime_error("joint " + std::to_string(i) + " does not go where it is told to");
  return stand;
}

void Arm::stay(double duration) {
  Parts& p = *parts_;
  // Not where it is: an arm that sags would sag each time.
  const JointAngles q = p.told.value_or(p.drive->start());
  const Nanoseconds begin = p.now;
  while (seconds<double>(p.now - begin) < duration) p.tell(q), p.hear();
}

Ride Arm::follow(const std::function<JointPoint(double)>& path, double duration) {
  Parts& p = *parts_;
  constexpr double rest = 1, apart = 0.0039;  // of two stamps [s]
  std::vector<double> time;
  std::vector<JointAngles> measured, torque, truth;
  const Nanoseconds begin = p.now;
  examples::job::Progress progress(p.options.quiet);
  for (double t = 0; t < duration + 2 * rest; t = seconds<double>(p.now - begin)) {
    if (time.empty() || t - time.back() > apart) {
      time.push_back(t);
      measured.push_back(p.drive->measured());
      truth.push_back(p.truth());
      torque.push_back(p.drive->currents());
      for (std::size_t i = 0; i < torque.back().size(); ++i)
        torque.back()[i] *= p.options.torque_per_ampere[i];
    }
    if (progress.due(t)) progress.show("  %4.0f of %.0f s", t, duration + 2 * rest);
    const Eigen::VectorXd at = path(std::clamp(t - rest, 0.0, duration)).q;
    p.tell(JointAngles(at.data(), at.data() + at.size()));
    p.hear();
  }
  progress.clear();
  const auto table = [&](const std::vector<JointAngles>& rows) {
    JointRecording out{time, Eigen::MatrixXd(Eigen::Index(rows.size()), Eigen::Index(rows.front().size()))};
    for (std::size_t k = 0; k < rows.size(); ++k)
      out.q.row(Eigen::Index(k)) =
          Eigen::Map<const Eigen::RowVectorXd>(rows[k].data(), Eigen::Index(rows[k].size()));
    return out;
  };
  return {begin, table(measured), table(torque).q, table(truth)};
}

}  // namespace calibrate_skin
