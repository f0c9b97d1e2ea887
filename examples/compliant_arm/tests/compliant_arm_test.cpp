// The job of a stiff arm in lock-step: it gives way to a push on its tool as configured, and comes back.
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
  s.urdf = COMPLIANT_ARM_URDF;
  s.quiet = true;
  s.simulation.speed = 0;
  s.duration = skinctl::testing::sanitized ? 4 : 8;
  simulate_by_default(s);
  return s;
}

}  // namespace

TEST_CASE("A stiff arm by position gives way to pushes on its tool and comes back, within its limits") {
  for (const Robot robot : {Robot::rsi, Robot::egm, Robot::stream_motion}) {
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
  }
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
