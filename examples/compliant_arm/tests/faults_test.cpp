// Everything that goes wrong between the job and a controller that is the clock: words, exit code, rest.
//
// Promise: what goes wrong between the job and a controller that is the clock ends in its words, at rest
// Tried: 87 rows of faults, of KUKA's two, ABB's, FANUC's and Franka's simulated controllers

#include <doctest/doctest.h>

#include <cstdio>

#include "examples/compliant_arm/tests/fault_rows.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_arm;
using namespace compliant_arm::faults;

TEST_SUITE_BEGIN("real time");

TEST_CASE("Faults of controller and link: words, exit code, time to rest") {
  if (skinctl::testing::sanitized) return;  // cycles of 4 ms mean nothing there
  std::printf("| robot | what goes wrong | exit | words | at rest after [ms] |\n");
  for (const Row& row : rows()) {
    const Ran ran = run_row(row);
    CAPTURE(std::string(row.name));
    CAPTURE(int(row.robot));
    CAPTURE(ran.log.reason);
    CAPTURE(ran.log.last.ended);
    CHECK(ran.exit == row.expected);
    CHECK(ran.log.reason.find(row.reason) != std::string::npos);
    if (row.expected != Exit::fine && ran.log.last.time > 0) CHECK(rest_of(ran.log) < 1);
    std::printf("| %s | %s | %d | %s | %.0f |\n",
                row.robot == Robot::rsi      ? "RSI"
                : row.robot == Robot::egm    ? "EGM"
                : row.robot == Robot::fri    ? "FRI"
                : row.robot == Robot::franka ? "FCI"
                                             : "stream motion",
                row.name, examples::job::code(ran.exit), ran.log.reason.c_str(), 1e3 * rest_of(ran.log));
  }
}

TEST_SUITE_END();
