// The main job without a skin: by the sensor in the wrist of an e-Series, and by the motors.
#include "examples/compliant_ur5/senses.hpp"

#include <doctest/doctest.h>

#include "examples/compliant_ur5/fault_runs.hpp"
#include "examples/compliant_ur5/noted.hpp"
#include "examples/compliant_ur5/tests/beside.hpp"

using namespace compliant_ur5;

namespace {

/// Of `r.sense`; by velocity, which answers sooner.
FaultRunResult run(FaultRun r) {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  read_scenario(s.scenario, s);
  r.interface = skinctl::Interface::velocity;
  return run_with_faults(s, r);
}
std::string finger(int cell, double start) {
  return "[[touch]]\ncell = " + std::to_string(cell) + "\nstart = " + std::to_string(start) +
         "\nstiffness = 1000\ndamping = 20\ntremor = 0.02\napproach_speed = 0.06\ntravel = 0.06\nhold = "
         "0.6\n";
}
/// How far a link has moved from where it was at the start, at most [m].
double moved(const RunLog& log) {
  RunLog still;
  still.entries.assign(log.entries.size(), log.entries.front());
  return farthest_apart(log, still);
}
std::string fact(const RunLog& log, const std::string& name) {
  for (const Fact& f : log.result)
    if (f.name == name) return f.value;
  return {};
}

constexpr const char* wrist_bias = "[force_sensor]\nforce_bias = [0, 0, 4]\nbias_from = 1\n";
constexpr const char* elbow_bias = "[motors]\ntorque_bias = [0, 0, 12, 0, 0, 0]\n";

}  // namespace

TEST_CASE(
    "senses: by the wrist's sensor the arm gives way at its tool, and not to what touches the forearm") {
  const auto tool = run({.duration = 4, .sense = Sense::wrist, .more = finger(257, 1)});
  REQUIRE(tool.outcome == Outcome::fine);
  REQUIRE(tool.log.touches.size() == 1);
  CHECK(tool.log.touches[0].link == 5);
  CHECK(tool.log.touches[0].deflection > 0.03);
  CHECK(tool.log.touches[0].true_peak_force < 35);  // 60 N on a rigid arm
  CHECK(fact(tool.log, "allocations in the loop") == "0");
  const auto forearm = run({.duration = 4, .sense = Sense::wrist, .more = finger(170, 1)});
  CHECK(forearm.outcome == Outcome::fine);
  CHECK(forearm.log.touches.empty());
  CHECK(forearm.log.peak_force > 55);
  CHECK(moved(forearm.log) < 1e-3);
}

TEST_CASE("senses: a bias of the wrist's sensor is named, and moves the arm by some millimetres") {
  // It comes to rest before it is found by its way, so that its time finds it.
  const auto watched = run({.duration = 13, .sense = Sense::wrist, .more = wrist_bias});
  CHECK(watched.outcome == Outcome::fine);
  CHECK(moved(watched.log) < 0.015);
  CHECK(fact(watched.log, "pushes without life, taken for rest").front() == '1');
  CHECK(fact(watched.log, "bias of the force found while running").substr(0, 2) == "4.");
  CHECK(has_noted(watched.log, skinctl::Reason::push_without_life));
  // One that is there from the start is tared before anything moves.
  const auto tared = run({.duration = 3,
                          .sense = Sense::wrist,
                          .more = "[force_sensor]\nforce_bias = [0, 9, 12]\nbias_from = 0\n"});
  CHECK(moved(tared.log) < 1e-3);
  CHECK(fact(tared.log, "bias of the force at the start") == "15.0 N");
  CHECK(fact(tared.log, "pushes without life, taken for rest") == "0");
}

TEST_CASE("senses: a recording by the wrist's sensor replays bit for bit") {
  Settings s = settings();
  s.scenario = WITHOUT_SKIN_SCENARIO;
  read_scenario(s.scenario, s);
  s.sense = Sense::wrist;
  s.rate = 500;
  s.cycles = 1000;
  s.record =
      (std::filesystem::temp_directory_path() / ("skinctl_senses_" + std::to_string(getpid()) + ".mcap"))
          .string();
  RunLog log;
  REQUIRE(compliant_ur5::run(s, false, log) == Outcome::fine);
  s.replay = std::exchange(s.record, {});
  CHECK(replay(s) == Outcome::fine);
  s.wrist.threshold = 4;
  CHECK_THROWS_AS(static_cast<void>(replay(s)), skinctl::ConfigurationError);
  std::filesystem::remove(s.replay);
}

TEST_CASE("senses: what cannot be tared, or is no number, ends with its words") {
  const auto noisy = run({.duration = 3, .sense = Sense::wrist, .more = "[force_sensor]\nforce_noise = 3\n"});
  CHECK(noisy.outcome == Outcome::blind);
  CHECK(noisy.log.ending == "not_tared");
  CHECK(noisy.log.words.find("change of force at rest") != std::string::npos);
  const auto saturated =
      run({.duration = 4,
           .sense = Sense::wrist,
           .more = "[force_sensor]\nforce_creep = [0, 0, 90]\nforce_bias = [0, 0, 950]\nbias_from = 1\n"});
  CHECK(saturated.outcome == Outcome::blind);
  CHECK(saturated.log.ending == "sense_silent");
  Settings torque;
  torque.scenario = COMPLIANT_UR5_SCENARIO;
  torque.sense = Sense::motors;
  torque.interface = skinctl::Interface::torque;
  torque.rate = 500;
  RunLog log;
  CHECK_THROWS_AS(compliant_ur5::run(torque, false, log), skinctl::ConfigurationError);
}

TEST_CASE("senses: by its motors the arm gives way anywhere, above the friction of its gears") {
  const auto forearm = run({.duration = 4, .sense = Sense::motors, .more = finger(170, 1)});
  REQUIRE(forearm.outcome == Outcome::fine);
  CHECK(moved(forearm.log) > 0.005);
  CHECK(forearm.log.peak_force < 59);  // 61 N on a rigid arm
  CHECK_FALSE(forearm.log.touches.empty());
  const auto untouched = run({.duration = 2, .sense = Sense::motors});
  CHECK(moved(untouched.log) < 1e-3);
  const auto biased = run({.duration = 12, .sense = Sense::motors, .more = elbow_bias});
  CHECK(biased.outcome == Outcome::fine);
  CHECK(moved(biased.log) < 0.03);
  CHECK(has_noted(biased.log, skinctl::Reason::push_without_life));
}
