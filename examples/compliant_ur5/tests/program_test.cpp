// The main job as a program: help, exit codes, signals, and readers that go away.
//
// Promise: the main job as a program: exit codes, signals, readers that go away
// Tried: SIGINT, SIGTERM, SIGHUP: stopped within 1 s with 130; the README's table is what `--endings`
// prints. Also: `examples/support/tests/job_test.cpp`

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "examples/compliant_ur5/endings.hpp"
#include "examples/support/own_input.hpp"

using examples::job::Exit;

namespace {

struct Ran {
  int exit = -1;  ///< -1: killed by a signal
  std::string out;
  double seconds = 0;  ///< from the signal, or the start
};

/// Runs the program; after a second of output `number` is sent, if it is not 0. `deaf`: nobody reads what it
/// prints.
Ran run(std::vector<std::string> words, int number = 0, bool deaf = false) {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  words.insert(words.begin(), COMPLIANT_UR5_PROGRAM);
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<char*> list;
    for (auto& w : words) list.push_back(w.data());
    list.push_back(nullptr);
    ::dup2(ends[1], 1);
    ::dup2(ends[1], 2);
    ::close(ends[0]);
    ::close(ends[1]);
    ::execv(list[0], list.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  Ran ran;
  auto from = std::chrono::steady_clock::now();
  if (deaf) ::close(ends[0]);
  if (number != 0) {
    char block[4096];
    while (ran.out.find("connected to") == std::string::npos) {
      const auto n = ::read(ends[0], block, sizeof block);
      REQUIRE(n > 0);
      ran.out.append(block, static_cast<std::size_t>(n));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    from = std::chrono::steady_clock::now();
    ::kill(child, number);
  }
  if (!deaf) {
    char block[4096];
    for (ssize_t n = 0; (n = ::read(ends[0], block, sizeof block)) > 0;)
      ran.out.append(block, static_cast<std::size_t>(n));
    ::close(ends[0]);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ran.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
  if (WIFEXITED(status)) ran.exit = WEXITSTATUS(status);
  return ran;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE(
    "program: --preset fast feels the first touch with a quarter of the sub-steps, others are refused") {
  const std::vector<std::string> common{"--no-compare", "--report", "", "--cycles", "700", "--preset"};
  const auto with = [&](const char* preset) {
    auto words = common;
    words.push_back(preset);
    return run(words);
  };
  // The row `touch, at, link, cell, peak, ...` of the first touch.
  const auto peak = [](const std::string& out) {
    double number = 0, at = 0, link = 0, cell = 0, force = 0;
    const auto head = out.find("return error");
    if (head == std::string::npos) return -1.0;
    std::istringstream row(out.substr(out.find('\n', head)));
    row >> number >> at >> link >> cell >> force;
    return number == 1 && cell == 170 ? force : -1.0;
  };
  const Ran balanced = with("balanced"), fast = with("fast"), slow = with("slow");
  CHECK(balanced.exit == 0);
  CHECK(fast.exit == 0);
  CHECK(peak(balanced.out) > 15);
  CHECK(peak(fast.out) ==
        doctest::Approx(peak(balanced.out)).epsilon(0.25));  // it is felt heavier, as it answers later
  CHECK(slow.exit != 0);
  CHECK(slow.out.find("--preset") != std::string::npos);
}

TEST_CASE("program: a computer that is too slow is named where the run ends for it") {
  const Ran ran = run({"--speed", "100", "--cycles", "12500", "--quiet", "--report", ""});
  if (ran.exit == 0) {
    MESSAGE("this computer simulates a UR5 and its skin a hundred times faster than they are");
  } else {
    CHECK_MESSAGE(
        ran.out.find("; this computer is too slow, or busy with something else: ") != std::string::npos,
        ran.out);
  }
}

TEST_CASE("program: --help tells every exit code, --endings the table that the README shows") {
  const Ran help = run({"--help"});
  CHECK(help.exit == 0);
  for (const auto& row : examples::job::exits) CHECK(help.out.find(row.words) != std::string::npos);
  CHECK(help.out.find("--simulate") != std::string::npos);
  const Ran endings = run({"--endings"});
  CHECK(endings.exit == 0);
  CHECK(endings.out == compliant_ur5::endings_as_markdown());
  std::ifstream readme(COMPLIANT_UR5_README);
  std::stringstream text;
  text << readme.rdbuf();
  CHECK(text.str().find(endings.out) != std::string::npos);
}

TEST_CASE("program: SIGINT, SIGTERM and SIGHUP stop it cleanly, within a second") {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    CAPTURE(number);
    const Ran ran =
        run({"--simulate", "--speed", "1", "--cycles", "2500", "--no-compare", "--report", ""}, number);
    CHECK(ran.exit == examples::job::code(Exit::interrupted));
    CHECK(ran.seconds < 1);
    CHECK(ran.out.find("stopped: interrupted (exit code 130") != std::string::npos);
  }
}

TEST_CASE("program: nothing that it writes is a file that it reads") {
  std::ifstream file(COMPLIANT_UR5_SCENARIO);
  const std::string scenario{std::istreambuf_iterator<char>(file), {}};
  for (const char* option : {"--report", "--json", "--picture", "--record"})
    examples::check_own_input_is_kept(COMPLIANT_UR5_PROGRAM,
                                      std::string("--cycles 5 --quiet --scenario IN ") + option + " OUT",
                                      scenario, 2);
  examples::check_own_input_is_kept(COMPLIANT_UR5_PROGRAM, "--cycles 5 --quiet --touch IN --json OUT",
                                    "0,0\n0.1,5\n0.2,0\n", 2);
}

TEST_CASE("program: wrong options are refused, a robot that is not there is told, a reader may leave") {
  CHECK(run({"--no-such-option"}).exit == examples::job::code(Exit::refused));
  CHECK(run({"--simulate", "--robot", "127.0.0.1"}).exit == examples::job::code(Exit::refused));
  CHECK(run({"--interface", "thought"}).exit == examples::job::code(Exit::refused));
  const Ran nobody = run({"--robot", "127.0.0.1", "--rtde-port", "1"});
  CHECK(nobody.exit == examples::job::code(Exit::lost));
  CHECK(nobody.out.find("cannot reach the robot's RTDE") != std::string::npos);
  CHECK(run({"--cycles", "250", "--no-compare", "--report", ""}, 0, true).exit == 0);
}

TEST_SUITE_END();
