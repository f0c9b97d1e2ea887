// What goes wrong between the job of an arm and its controller, and how it must end.
#pragma once

#include <vector>

#include "examples/adapters/socket.hpp"
#include "examples/compliant_arm/run.hpp"
#include "skinctl/core/contract.hpp"

namespace compliant_arm::faults {

using examples::job::Exit;
using simulated_arm::Faults;

inline constexpr double at = 0.6;  ///< when it goes wrong [s]

struct Row {
  Robot robot;
  const char* name;
  Settings settings;
  Exit expected;
  const char* reason = "";  ///< in the job's words
};

inline Settings settings_of(Robot robot) {
  Settings s;
  s.robot = robot;
  simulate_by_default(s);
  s.simulation.pushes = {{.start = 0.4, .duration = 1.2, .force = {0, 0, 40}}};
  s.simulation.faults.from = at;
  s.quiet = true;
  s.duration = 1.5;
  return s;
}
inline std::vector<Row> rows() {
  std::vector<Row> out;
  const auto row = [&](Robot robot, const char* name, Exit expected, const char* reason, auto&& change) {
    Row r{robot, name, settings_of(robot), expected, reason};
    change(r.settings);
    out.push_back(std::move(r));
  };
  const auto fault = [](auto Faults::* what, auto value) {
    return [what, value](Settings& s) { s.simulation.faults.*what = value; };
  };
  const char* silent = "the controller has fallen silent";
  for (const Robot robot : {Robot::rsi, Robot::egm, Robot::fri, Robot::stream_motion, Robot::franka}) {
    const bool kuka = robot == Robot::rsi, abb = robot == Robot::egm, iiwa = robot == Robot::fri,
               fr3 = robot == Robot::franka;
    row(robot, "1 % of its datagrams lost", Exit::fine, "", fault(&Faults::lose, 0.01));
    row(robot, "10 % of its datagrams lost", Exit::fine, "", fault(&Faults::lose, 0.1));
    row(robot, "1 % of the answers lost", Exit::fine, "", fault(&Faults::lose_answers, 0.01));
    row(robot, "every datagram twice", Exit::fine, "", fault(&Faults::twice, 1.0));
    row(robot, "a tenth of the datagrams behind the next one", Exit::fine, "", fault(&Faults::swap, 0.1));
    const auto damaged = [](Settings& s) { s.simulation.faults.cut = s.simulation.faults.garbled = 0.05; };
    row(robot, "5 % of the datagrams cut, 5 % noise", Exit::fine, "", damaged);
    row(robot, "every datagram is noise", Exit::lost, silent, fault(&Faults::garbled, 1.0));
    // EGM does not count them: the arm follows later.
    row(robot, "every answer two cycles late",
        abb           ? Exit::fine
        : kuka || fr3 ? Exit::lost
                      : Exit::halted,
        abb    ? ""
        : kuka ? "the controller counts answers as late"
        : iiwa ? "quality is below GOOD"
        : fr3  ? "communication_constraints_violation"
               : "they came late",
        fault(&Faults::late_answers, fr3                   ? 0.002
                                     : kuka || abb || iiwa ? 0.008
                                                           : 0.016));
    // By a cycle of 1 ms some answers of the last window may have been late, on a computer with other work.
    row(robot, "the cable is cut, or the controller ends", Exit::lost, fr3 ? "the controller" : silent,
        fault(&Faults::silent_at, at));
    row(robot, "emergency stop", kuka ? Exit::lost : Exit::halted,
        kuka ? silent : "the robot takes no more motion", fault(&Faults::halted_at, at));
    row(robot, "its program begins anew: numbers go back", Exit::implausible, "went back or leapt",
        fault(&Faults::restart_at, at));
    row(robot, "it answers nothing", Exit::lost, "", fault(&Faults::mute, true));
  }
  using adapters::fri::Control;
  using adapters::fri::Overlay;
  const auto of_fri = [](auto simulated_arm::FriConfig::* what, auto value) {
    return [what, value](Settings& s) { s.fri_controller.*what = value; };
  };
  row(Robot::fri, "fewer than seven axes", Exit::refused, "another number of joints",
      fault(&Faults::fewer_joints, true));
  row(Robot::fri, "another send period than declared", Exit::refused, "is another period",
      of_fri(&simulated_arm::FriConfig::send_period, 5u));
  row(Robot::fri, "Cartesian impedance", Exit::refused, "its control mode is Cartesian impedance",
      of_fri(&simulated_arm::FriConfig::control, Control::cartesian_impedance));
  row(Robot::fri, "position control under a job for springs", Exit::refused, "its control mode is position",
      of_fri(&simulated_arm::FriConfig::control, Control::position));
  row(Robot::fri, "ClientCommandMode.WRENCH", Exit::refused, "its client command mode is WRENCH",
      of_fri(&simulated_arm::FriConfig::overlay, Overlay::wrench));
  row(Robot::fri, "ClientCommandMode.TORQUE, not declared", Exit::refused,
      "its client command mode is TORQUE", of_fri(&simulated_arm::FriConfig::overlay, Overlay::torque));
  row(Robot::fri, "its motion ends: the session falls back", Exit::halted, "fell back from COMMANDING_ACTIVE",
      of_fri(&simulated_arm::FriConfig::motion_ends_at, at));
  row(Robot::fri, "half of its datagrams lost", Exit::halted, "quality is below GOOD",
      fault(&Faults::lose, 0.5));
  row(Robot::fri, "its quality falls to POOR", Exit::halted, "quality is below GOOD",
      of_fri(&simulated_arm::FriConfig::poor_at, at));
  row(Robot::fri, "a safety stop before it begins", Exit::lost, "its safety state is not normal",
      fault(&Faults::halted_at, 0.0));
  row(Robot::fri, "no motion in its program", Exit::lost, "the session stays in MONITORING_READY",
      of_fri(&simulated_arm::FriConfig::motion_begins, false));
  row(Robot::fri, "no external torques", Exit::blind, "hold no forces",
      of_fri(&simulated_arm::FriConfig::tells_external, false));
  const auto of_franka = [](auto simulated_arm::FrankaConfig::* what, auto value) {
    return [what, value](Settings& s) { s.franka_controller.*what = value; };
  };
  row(Robot::franka, "another version of FCI", Exit::refused, "speaks version 9 of FCI, not 7",
      of_franka(&simulated_arm::FrankaConfig::version, std::uint16_t{9}));
  row(Robot::franka, "FCI is not activated, or its brakes are closed", Exit::lost, "is FCI activated",
      of_franka(&simulated_arm::FrankaConfig::takes_motion, false));
  row(Robot::franka, "user stop before it begins", Exit::lost, "its user stop is pressed",
      fault(&Faults::halted_at, 0.0));
  row(Robot::franka, "a push above the thresholds of collisions", Exit::halted, "joint_reflex",
      [](Settings& s) { s.franka.collision_torque = 8; });
  row(Robot::franka, "a force above them", Exit::halted, "cartesian_reflex",
      [](Settings& s) { s.franka.collision_force = 20; });
  row(Robot::franka, "half of its datagrams lost", Exit::lost, "the controller counts answers as late",
      fault(&Faults::lose, 0.5));
  row(Robot::franka, "half of the answers lost", Exit::lost, "the controller counts answers as late",
      fault(&Faults::lose_answers, 0.5));
  row(Robot::egm, "fewer than six axes", Exit::refused, "another number of joints",
      fault(&Faults::fewer_joints, true));
  row(Robot::egm, "another \\SampleRate than declared", Exit::refused, "datagrams come every",
      [](Settings& s) { s.egm_controller.period = 0.012; });
  row(Robot::rsi, "fewer than six axes", Exit::refused, "another number of joints",
      fault(&Faults::fewer_joints, true));
  row(Robot::rsi, "another cycle than declared", Exit::refused, "grow by 12", [](Settings& s) {
    s.rsi_controller.period = 0.012;
    s.rsi_controller.ipoc_per_cycle = 12;
  });
  row(Robot::rsi, "HOLDON=0, 10 % of the answers lost", Exit::lost, "the controller", [](Settings& s) {
    s.rsi_controller.hold_on = false;
    s.simulation.faults.lose_answers = 0.1;
  });
  row(Robot::rsi, "relative corrections, 10 % of the answers lost", Exit::lost, "one is missing",
      [](Settings& s) {
        s.rsi.correction = s.rsi_controller.correction = adapters::rsi::Correction::relative;
        s.simulation.faults.lose_answers = 0.1;
      });
  row(Robot::rsi, "AXISCORRMON tighter than declared", Exit::lost, silent,
      [](Settings& s) { s.rsi_controller.axis_corr_mon = 0.5; });
  row(Robot::stream_motion, "tables of jerk and acceleration tighter than those it states", Exit::halted,
      "perhaps a limit of jerk", [](Settings& s) { s.stream_motion_controller.strictness = 0.01; });
  return out;
}

struct Ran {
  Exit exit{};
  RunLog log;
};
/// With the exit code and the words of the program.
inline Ran run_row(const Row& row) {
  Ran out;
  try {
    out.exit = run(row.settings, false, out.log);
  } catch (const skinctl::ConfigurationError& e) {
    out.exit = Exit::refused;
    out.log.reason = e.what();
  } catch (const adapters::ConnectionError& e) {
    out.exit = Exit::lost;
    out.log.reason = e.what();
  }
  return out;
}
/// From the fault until the last joint rested [s]; 0 if it rested before.
inline double rest_of(const RunLog& log) {
  return std::max(0.0, log.last.moved_at - at);
}

}  // namespace compliant_arm::faults
