// Two jobs in one process, and the program with a simulated UR5 and a simulated hand on loopback.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "examples/compliant_arm_and_hand/carried.hpp"
#include "examples/compliant_arm_and_hand/pair.hpp"
#include "examples/support/run_program.hpp"
#include "skinctl/dynamics/gravity.hpp"

using namespace arm_and_hand;
using namespace std::chrono_literals;

namespace {

Exit until_stopped(const std::atomic<bool>& stop) {
  for (int k = 0; k < 5000 && !stop; ++k) std::this_thread::sleep_for(1ms);
  return stop ? Exit::interrupted : Exit::fine;
}
/// Runs a job for 20 ms.
auto ends(Exit exit) {
  return [exit](const std::atomic<bool>&) {
    std::this_thread::sleep_for(20ms);
    return exit;
  };
}

int program(std::vector<const char*> arguments, int signal = 0, int ms = 0) {
  return examples::run_and_signal(ARM_AND_HAND_PROGRAM, std::move(arguments), signal, ms);
}

}  // namespace

TEST_CASE("What the arm's controller is told of the hand holds the hand, whatever its fingers do") {
  using namespace skinctl;
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> any(-1.5, 1.5);
  for (const auto side : {allegro::Side::right, allegro::Side::left})
    for (int k = 0; k < 50; ++k) {
      JointPosition<6> arm;
      JointPosition<22> whole;
      std::array<double, 16> fingers{};
      for (double& q : fingers) q = any(rng);
      for (std::size_t i = 0; i < 22; ++i) whole[i] = i < 6 ? (arm[i] = any(rng)) : fingers[i - 6];
      const auto told = carried(side, fingers, 0, nullptr);
      CHECK(told.mass == doctest::Approx(0.9549).epsilon(1e-12));
      CHECK(told.centre[2] > 0.0475);  // beyond the middle of the palm, which stands on the flange
      CHECK(told.centre[2] < 0.18);
      LinkInertia load{told.mass, {}, 0, 0, 0};
      for (std::size_t i = 0; i < 3; ++i) load.c[i] = told.centre[i] + ur5::Description::flange[i];
      // KDL and MuJoCo agree with the whole of it (tests/robots/ur5_allegro_test.cpp).
      const auto holds = gravity_torque(ur5_allegro::arm_with_hand(side), whole);
      const auto held = gravity_torque(Loaded<ur5::Model, 5>(ur5::Model{}, load), arm);
      for (std::size_t i = 0; i < 6; ++i) CHECK(held[i] == doctest::Approx(holds[i]).epsilon(1e-11).scale(1));
    }
}

TEST_SUITE_BEGIN("real time");

TEST_CASE(
    "The program: a press on the palm of a V5 Sense does not move the arm, unless it is asked to count") {
  const std::string said = examples::run_program(ARM_AND_HAND_PROGRAM,
                                                 "--generation v5_sense --duration 3 --palm-touch-at 1.5", 0);
  CHECK(said.find("carries 0.95 kg") != std::string::npos);
  CHECK(said.find("palm pressed at") == std::string::npos);
  CHECK(said.find("machine a thread without work") != std::string::npos);
}

TEST_CASE(
    "The program: a palm that counts moves the arm, is believed as long as it is pressed, and stops "
    "nothing") {
  const std::string said = examples::run_program(
      ARM_AND_HAND_PROGRAM, "--generation v5_sense --duration 4 --palm-gain 5 --palm-touch-at 1.5", 0);
  const auto at = said.find("palm pressed at");
  REQUIRE(at != std::string::npos);
  const auto way = said.find("gave way by ", at);
  REQUIRE(way != std::string::npos);
  const double moved = std::atof(said.c_str() + way + 12);
  CHECK(moved > 10);
  CHECK(moved < 80);
  CHECK(said.find("261 of 261") != std::string::npos);
}

TEST_CASE("Two jobs: both end well, one fails, one throws, both are interrupted") {
  const std::atomic<bool> nobody{false}, somebody{true};
  CHECK(run_both(ends(Exit::fine), ends(Exit::fine), nobody).exit() == Exit::fine);
  for (const bool arm_fails : {true, false}) {
    const auto ran = arm_fails ? run_both(ends(Exit::halted), until_stopped, nobody)
                               : run_both(until_stopped, ends(Exit::halted), nobody);
    CHECK(ran.exit() == Exit::halted);
    CHECK((arm_fails ? ran.hand : ran.arm).exit == Exit::interrupted);
    CHECK((arm_fails ? ran.hand : ran.arm).stopped_with_other);
  }
  // The hand fails first, and the arm fails because of that.
  const auto both = run_both(
      [](const std::atomic<bool>& stop) {
        until_stopped(stop);
        return Exit::blind;
      },
      ends(Exit::lost), nobody);
  CHECK(both.exit() == Exit::lost);
  const auto thrown = run_both(
      until_stopped, [](const std::atomic<bool>&) -> Exit { throw std::runtime_error("no hand"); }, nobody);
  CHECK(thrown.exit() == Exit::lost);
  CHECK(thrown.hand.words == "no hand");
  CHECK(run_both(until_stopped, until_stopped, somebody).exit() == Exit::interrupted);
}

TEST_CASE("The program: arm and hand simulated, a hand that leaves, a signal, wrong options") {
  CHECK(program({"--help"}) == 0);
  CHECK(program({"--simulate", "--can", "can0"}) == 2);
  CHECK(program({"--can", "no_such_interface"}) == 1);
  CHECK(program({"--duration", "1.5", "--speed", "0"}) == 0);
  CHECK(program({"--duration", "20", "--hand-unplugged-at", "0.3"}) == 1);
  CHECK(program({"--duration", "20"}, SIGINT, 500) == 130);
}

TEST_SUITE_END();
