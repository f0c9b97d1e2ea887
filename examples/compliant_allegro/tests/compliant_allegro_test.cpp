// The hand's job against simulated hands, and its program.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "examples/compliant_allegro/run.hpp"
#include "examples/simulated_allegro/simulated_hand.hpp"
#include "examples/support/run_program.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_allegro;
using examples::job::Exit;

namespace {

RunLog ran(Generation g, Side side, bool udp = false) {
  Settings s;
  default_task(s);
  s.quiet = true;
  s.generation = g;
  s.side = side;
  s.simulate_udp = udp;
  RunLog log;
  REQUIRE(run(s, false, log) == Exit::fine);
  return log;
}

int program(std::vector<const char*> arguments, int signal = 0, int ms = 0) {
  return examples::run_and_signal(COMPLIANT_ALLEGRO_PROGRAM, std::move(arguments), signal, ms);
}

}  // namespace

TEST_CASE("The hand gives way to touches, comes back, and closes with all fingers on a ball") {
  double with_cells = 0, without = 0;
  for (const Generation g : {Generation::v5_sense, Generation::v4}) {
    for (const Side side : {Side::right, Side::left}) {
      if (skinctl::testing::sanitized && side == Side::left) continue;
      CAPTURE(int(g));
      CAPTURE(int(side));
      const RunLog log = ran(g, side, side == Side::left && g == Generation::v5_sense);
      REQUIRE(log.touches.size() == 2);
      CHECK(log.touches[0].cell == 3);
      CHECK(log.touches[1].cell == 10);
      for (const TouchSummary& t : log.touches) {
        CHECK(t.moved > 5e-3);
        CHECK(t.moved < 40e-3);
        CHECK(t.after >= 0);
        CHECK(t.after < 0.1);  // the finger itself takes 0.1 s to its full force
        CHECK(t.return_error < 3e-3);
      }
      (g == Generation::v4 ? without : with_cells) += log.touches[0].moved;
      for (const double n : log.ball) CHECK(n > 0.3);
      CHECK(log.incomplete == 0);
      CHECK(log.silent == 0);
      const bool udp = side == Side::left && g == Generation::v5_sense;
      CHECK(log.last.servo == udp);  // whose protocol has no servo off
      CHECK(log.last.torque == PerJoint{});
      double speed = 0;
      for (const LogEntry& e : log.entries) {
        for (std::size_t i = 0; i < 16; ++i) CHECK(std::isfinite(e.q[i] + e.torque[i]));
        if (e.time > 16.5)
          for (std::size_t i = 0; i < 16; ++i)
            speed = std::max(speed, double(std::abs(e.q[i] - log.entries.back().q[i])));
      }
      CHECK(speed < 0.02);  // at rest again
    }
  }
  CHECK(with_cells > 1.5 * without);  // cells add to what friction and springs give way by themselves
}

TEST_CASE("The report is whole, says what happened and needs nothing else") {
  const RunLog log = ran(Generation::v5_sense, Side::right);
  const std::string page = report(log);
  CHECK(page.find("gave way to 2 touches") != std::string::npos);
  CHECK(page.find("Index, tip") != std::string::npos);
  CHECK(page.find("nan") == std::string::npos);
  CHECK(page.find("http") == page.npos);
  CHECK(page.ends_with("</main></body></html>\n"));
  std::size_t figures = 0, closed = 0;
  for (std::size_t at = page.find("<figure"); at != page.npos; at = page.find("<figure", at + 1)) ++figures;
  for (std::size_t at = page.find("</figure>"); at != page.npos; at = page.find("</figure>", at + 1))
    ++closed;
  CHECK(figures == 6);
  CHECK(closed == 6);
  RunLog empty;
  empty.reason = "<b>lost</b>";
  CHECK(report(empty).find("<b>") == std::string::npos);
}

TEST_CASE("The program: says what it assumed of a V5's gears, unless they are chosen") {
  const auto says = [](const std::string& arguments) {
    return examples::run_program(COMPLIANT_ALLEGRO_PROGRAM, arguments + " --duration 0.3 --quiet", 0);
  };
  CHECK(says("--generation v5").find("(5TAR0042) geared in joints 1, 5 and 9?") != std::string::npos);
  for (const char* said : {"--generation v5 --geared yes", "--generation v5 --geared no", "--generation v4",
                           "--generation v5_sense", "--generation v5_sense --geared no"})
    CHECK_MESSAGE(says(said).empty(), said);
  CHECK(program({"--generation", "v4", "--geared", "no"}) == 2);
  CHECK(program({"--generation", "v5", "--geared", "perhaps"}) == 2);
}

TEST_CASE("The program: help, wrong options, no device, signals") {
  CHECK(program({"--help"}) == 0);
  CHECK(program({"--no-such-option"}) == 2);
  CHECK(program({"--generation", "v3"}) == 2);
  CHECK(program({"--simulate", "--can", "can0"}) == 2);
  CHECK(program({"--simulate-udp", "--generation", "v5"}) == 2);
  CHECK(program({"--can", "no_such_interface"}) == 1);
  CHECK(program({"--can", "/dev/no_such_tty"}) == 1);
  CHECK(program({"--duration", "0.5", "--quiet", "--generation", "v5"}) == 0);
  simulated_allegro::Config
      config;  // by a real address: a line with an slcan adapter, over which the guardian watches
  config.generation = Generation::v4;
  simulated_allegro::SimulatedHand hand(config);
  const std::string line = hand.terminal();
  CHECK(program({"--can", line.c_str(), "--generation", "v4", "--duration", "0.4", "--quiet"}) == 0);
  CHECK(hand.snapshot().torques > 20);
  for (int k = 0; k < 500 && hand.snapshot().servo; ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK_FALSE(hand.snapshot().servo);
  CHECK(program({"--can", line.c_str(), "--generation", "v4", "--side", "left"}) == 1);
  CHECK(program({"--speed", "1"}, SIGINT, 300) == 130);
  CHECK(program({"--speed", "1"}, SIGTERM, 300) == 130);
}
