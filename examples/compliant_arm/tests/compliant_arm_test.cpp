// The job of an arm in lock-step: it gives way to a push on its tool as configured, and comes back.
#include <doctest/doctest.h>

#include <cmath>

#include "examples/compliant_arm/run.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_arm;
using examples::job::Exit;

namespace {

Settings settings(Robot robot) {
  Settings s;
  s.robot = robot;
  s.quiet = true;
  s.simulation.speed = 0;
  s.duration = skinctl::testing::sanitized ? 4 : 8;
  simulate_by_default(s);
  return s;
}

}  // namespace

TEST_CASE("An arm gives way to pushes on its tool and comes back, within its limits") {
  for (const Robot robot : {Robot::rsi, Robot::egm, Robot::fri, Robot::stream_motion, Robot::franka}) {
    CAPTURE(int(robot));
    RunLog log;
    CHECK(run(settings(robot), false, log) == Exit::fine);
    CHECK(log.reason == "");
    REQUIRE(log.pushes.size() == (skinctl::testing::sanitized ? 1 : 2));
    for (const PushSummary& p : log.pushes) {
      CHECK(p.moved > 0.004);
      CHECK(p.moved < 0.2);
      CHECK(p.left < 0.3 * p.moved);
    }
    CHECK(log.counts.lost == 0);
    CHECK(log.peak[2] > 0.1);  // the pushes are felt in the commands
    CHECK(log.peak[2] <= 1.01);
    CHECK((log.bent > 0.03) == on_springs(robot));  // 40 N on 500 N m/rad
  }
}

TEST_CASE("An arm on springs comes back whatever their stiffness, by torque and by other periods") {
  const auto gives_way = [](const Settings& s) {
    RunLog log;
    CHECK(run(s, false, log) == Exit::fine);
    CHECK(log.reason == "");
    REQUIRE(log.pushes.size() == 1);
    CHECK(log.pushes[0].force == doctest::Approx(40).epsilon(0.1));
    CHECK(log.pushes[0].moved > 0.03);
    CHECK(log.pushes[0].moved < 0.2);
    CHECK(log.pushes[0].left < 0.1 * log.pushes[0].moved);
    CHECK(log.peak[2] <= 1.01);
    return log;
  };
  auto s = settings(Robot::fri);
  s.duration = 4;
  double softer = 1;
  for (const double k : {200.0, 500.0, 2000.0}) {
    CAPTURE(k);
    s.stiffness = s.fri_controller.arm.stiffness = k;
    const RunLog log = gives_way(s);
    CHECK(log.bent < softer);
    softer = log.bent;
  }
  s = settings(Robot::franka);
  s.duration = 4;
  softer = 1;
  for (const double k : {200.0, 500.0, 2000.0}) {
    CAPTURE(k);
    s.stiffness = k;
    const RunLog log = gives_way(s);
    CHECK(log.bent < softer);
    softer = log.bent;
  }
  s = settings(Robot::fri);
  s.duration = 4;
  s.fri.overlay = s.fri_controller.overlay = adapters::fri::Overlay::torque;
  s.fri_controller.send_period = 2;
  s.fri.period = skinctl::nanoseconds(0.002);
  gives_way(s);
  s.fri_controller.send_period = 1, s.fri_controller.multiplier = 2;  // every second message has an answer
  const RunLog second = gives_way(s);
  CHECK(second.counts.lost == 0);
  CHECK(second.counts.doubled == 0);
}

TEST_CASE("An iiwa that does not tell the torque of the world, or a load told wrong, does not lead the arm") {
  auto s = settings(Robot::fri);
  s.duration = 3;
  s.fri_controller.tells_external = false;
  RunLog blind;
  CHECK(run(s, false, blind) == Exit::blind);
  s = settings(Robot::fri);
  s.duration = 3;
  s.simulation.pushes.clear();
  s.fri_controller.arm.torque_error = 1.5;  // within the threshold of 2 N m
  RunLog log;
  CHECK(run(s, false, log) == Exit::fine);
  CHECK(log.pushes.empty());
}

TEST_CASE("A robot that answers later is felt heavier") {
  auto s = settings(Robot::rsi);
  s.simulation.pushes.clear();
  s.duration = 0.2;
  RunLog early, late;
  CHECK(run(s, false, early) == Exit::fine);
  s.delay += 0.05;
  CHECK(run(s, false, late) == Exit::fine);
  CHECK(late.felt_mass > 2 * early.felt_mass);
}

TEST_CASE("An arm without a sensor in its wrist stays where it is") {
  auto s = settings(Robot::stream_motion);
  s.stream_motion_controller.version = 3;  // no forces in its states
  s.duration = 3;
  RunLog log;
  CHECK(run(s, false, log) == Exit::blind);
  CHECK(log.reason.find("no forces") != std::string::npos);
}

TEST_CASE("An identification finds delay and lag of an arm, and the stiffness of springs that were pushed") {
  if (skinctl::testing::sanitized) return;
  for (const Robot robot : {Robot::rsi, Robot::egm, Robot::fri, Robot::stream_motion, Robot::franka}) {
    CAPTURE(int(robot));
    auto s = settings(robot);
    s.identify = true;
    s.simulation.pushes.clear();
    if (on_springs(robot)) s.simulation.pushes = {{16, 4, {20, 20, 20}}};
    RunLog log;
    CHECK(run(s, false, log) == Exit::fine);
    CHECK(log.found.known);
    CHECK(std::abs(log.found.both - s.delay - s.lag) < std::max(4 * log.found.deviation, 5e-3));
    CHECK(log.found.deviation < 5e-3);
    if (!on_springs(robot)) {
      CHECK(log.found.stiffness.empty());
      continue;
    }
    REQUIRE(log.found.stiffness.size() == 7);
    int known = 0;
    for (const double k : log.found.stiffness) {
      if (k > 0) CHECK(k == doctest::Approx(s.stiffness).epsilon(0.1));
      known += k > 0;
    }
    CHECK(known >= 2);
  }
}
