// Identifies how an arm answers position commands: delay, lag, stiffness of its servos, gap and resolution of
// its encoders. Moves a UR5 gently, real or simulated, or reads a log.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <fstream>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/identify_robot/result.hpp"
#include "examples/support/job.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "skinctl/calibration/response_motion.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/undeclared_joints.hpp"

namespace {

using namespace identify_robot;
using skinctl::Nanoseconds;
using skinctl::ResponseMotion;
using skinctl::testing::JointTruth;
using skinctl::testing::UndeclaredJoints;

struct Truth {
  double delay = 0.008, lag = 0.038, stiffness = 0, gap = 0, noise = 2e-5, resolution = 0, skipped = 0;
};

Log simulate(const ResponseMotion<6>::Settings& settings, const Truth& told) {
  const std::array<double, 6> home{0, -1.2, 1.4, -1.8, -1.57, 0.3};
  JointTruth<6> truth;
  truth.delay = told.delay;
  truth.lag = told.lag;
  if (told.stiffness > 0) truth.stiffness = truth.all(told.stiffness);
  truth.inertia = truth.all(0.1);
  truth.gap = truth.all(told.gap);
  truth.noise = told.noise;
  truth.resolution = told.resolution;
  truth.skipped = told.skipped;
  UndeclaredJoints<6> joints(UndeclaredJoints<6>::Kind::position, truth, home);
  const ResponseMotion<6> motion(home, settings);
  Log log;
  for (int k = 0; k * 0.008 < settings.duration; ++k) {
    const double t = k * 0.008;
    const auto G = skinctl::gravity_torque(skinctl::ur5::Model{}, skinctl::JointPosition<6>(joints.q()));
    std::array<double, 6> load{};
    for (std::size_t i = 0; i < 6; ++i) load[i] = -G[i];
    joints.external(load);
    joints.advance(t);
    const auto& m = joints.measured();
    if (m.fresh) log.measured.push_back({m.time, m.q});
    const auto q = motion.at(t);
    log.sent.push_back({t, q});
    joints.command(t, q);
  }
  return log;
}

/// Empty when it was interrupted; the robot is told to stop then, as at any end.
Log move(const std::string& host, double rate, const ResponseMotion<6>::Settings& settings,
         const std::atomic<bool>& stop) {
  adapters::ur5::DriverConfig config;
  config.host = host;
  config.rate = rate;
  adapters::ur5::Driver driver(config);
  driver.connect();
  skinctl::State<6> state;
  if (driver.wait(state) != skinctl::Heard::state)
    throw std::runtime_error("no state from the robot: " + driver.error());
  const Nanoseconds begin = state.time;
  std::array<double, 6> start{};
  for (std::size_t i = 0; i < 6; ++i) start[i] = state.q[i];
  const ResponseMotion<6> motion(start, settings);
  Log log;
  examples::job::Progress progress(false);
  for (double t = 0; t < settings.duration;) {
    if (stop) {
      driver.stop();
      return {};
    }
    if (progress.due(t)) progress.show("%4.0f of %.0f s", t, settings.duration);
    const auto q = motion.at(t);
    skinctl::PositionCommand<6> command;
    command.valid = true;
    command.time = state.time;
    command.position = skinctl::JointPosition<6>(q);
    if (!driver.send(command)) throw std::runtime_error("the robot takes no commands: " + driver.error());
    log.sent.push_back({t, q});
    const auto heard = driver.wait(state);
    if (heard == skinctl::Heard::lost) throw std::runtime_error("the robot was lost: " + driver.error());
    t = skinctl::seconds<double>(state.time - begin);
    if (heard == skinctl::Heard::state) {
      std::array<double, 6> measured{};
      for (std::size_t i = 0; i < 6; ++i) measured[i] = state.q[i];
      log.measured.push_back({t, measured});
    }
  }
  driver.stop();
  progress.clear();
  return log;
}

}  // namespace

int main(int argc, char** argv) {
  namespace job = examples::job;
  CLI::App app(
      "Identifies how a UR5 answers position commands: delay, lag, stiffness, gap, resolution, jitter.\n"
      "Without --robot and --log it moves a simulated arm.");
  std::string robot, read, save, output;
  double rate = 125;
  ResponseMotion<6>::Settings motion;
  Truth truth;
  auto* host = app.add_option("--robot", robot, "host of a UR5 that is switched on: it moves, gently");
  app.add_option("--log", read, "a log instead: lines `sent,TIME,Q0..Q5` and `measured,TIME,Q0..Q5`")
      ->excludes(host);
  app.add_option("--rate", rate, "of states and commands of the robot [1/s]")
      ->check(CLI::Range(10.0, 1000.0));
  app.add_option("--amplitude", motion.amplitude, "of the motion [rad]");
  app.add_option("--speed", motion.speed, "at most [rad/s]");
  app.add_option("--duration", motion.duration, "of the motion [s]");
  app.add_option("--save-log", save, "write the log to this file");
  app.add_option("--output", output, "write the result to this TOML file");
  app.add_option("--delay", truth.delay, "of the simulated arm [s]")->check(CLI::Range(0.0, 0.1));
  app.add_option("--lag", truth.lag, "of the simulated arm [s]")->check(CLI::Range(0.0, 0.1));
  app.add_option("--stiffness", truth.stiffness, "of its servos [N m/rad], 0: rigid")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--gap", truth.gap, "of its encoders [rad]")->check(CLI::Range(-1.0, 1.0));
  app.add_option("--noise", truth.noise, "of its encoders [rad]")->check(CLI::Range(0.0, 0.1));
  app.add_option("--resolution", truth.resolution, "of its encoders [rad]")->check(CLI::Range(0.0, 0.1));
  app.add_option("--skipped", truth.skipped, "share of its measurements that are lost")
      ->check(CLI::Range(0.0, 0.9));
  bool simulated = false;
  app.add_flag("--simulate", simulated, "a simulated arm (the default)")->excludes(host);
  app.footer(job::exit_help());
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;
  try {
    for (const std::string& file : {save, output}) examples::refuse_own_input(file, {read});
    if (robot.empty() && read.empty()) std::printf("a simulated arm moves for %.0f s\n\n", motion.duration);
    if (!robot.empty()) {
      std::printf("%s moves for %.0f s, %.2f rad to both sides of where it stands, at most %.2f rad/s\n\n",
                  robot.c_str(), motion.duration, motion.amplitude, motion.speed);
      std::fflush(stdout);
    }
    const Log log = !read.empty() ? read_log(read)
                                  : (robot.empty() ? simulate(motion, truth)
                                                   : move(robot, rate, motion, signals.asked()));
    if (signals.asked()) return job::code(job::Exit::interrupted);
    if (!save.empty()) write_log(save, log);
    const Response found = identify(log);
    std::fputs(in_words(found).c_str(), stdout);
    if (const std::string why = why_unusable(found); !why.empty()) skinctl::refuse(why);
    if (!output.empty()) {
      std::ofstream file(output);
      if (!(file << as_toml(found)).flush())
        throw skinctl::ConfigurationError(output + ": cannot be written");
      std::printf("written to %s\n", output.c_str());
    }
    return job::code(job::Exit::fine);
  } catch (const skinctl::ConfigurationError& e) {
    std::fprintf(stderr, "identify_robot: %s\n", e.what());
    return job::code(job::Exit::refused);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "identify_robot: %s\n", e.what());
    return job::code(job::Exit::lost);
  }
}
