#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "examples/identify_robot/result.hpp"
#include "examples/support/own_input.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace identify_robot;

namespace {

std::string temporary(const char* name) {
  const auto unique = std::chrono::steady_clock::now().time_since_epoch().count();
  return (std::filesystem::temp_directory_path() / (std::string(name) + std::to_string(unique))).string();
}
std::string text_of(const std::string& file) {
  std::ostringstream out;
  out << std::ifstream(file).rdbuf();
  return out.str();
}
struct Ran {
  int code;
  std::string words;
};
Ran run(const std::string& options) {
  const std::string file = temporary("identify_out");
  const int code =
      std::system((std::string(IDENTIFY_ROBOT_PROGRAM) + " " + options + " > " + file + " 2>&1").c_str());
  Ran out{code, text_of(file)};
  std::remove(file.c_str());
  return out;
}
double number(const std::string& toml, const std::string& name) {
  const auto at = toml.find("\n" + name + " = ");
  REQUIRE(at != std::string::npos);
  return std::stod(toml.substr(at + name.size() + 4));
}

}  // namespace

TEST_CASE("identify_robot: finds what the simulated arm was told to be, and its log gives the same again") {
  const std::string log = temporary("identify_log"), toml = temporary("identify_toml"),
                    again = temporary("again");
  const auto first =
      run("--delay 0.012 --lag 0.03 --gap 0.04 --stiffness 3000 --save-log " + log + " --output " + toml);
  CAPTURE(first.words);
  REQUIRE(first.code == 0);
  const std::string found = text_of(toml);
  CHECK(std::abs(number(found, "delay") - 0.012) < 1e-3);
  CHECK(std::abs(number(found, "lag") - 0.03) < 2e-3);
  CHECK(first.words.find("beside its commands") != std::string::npos);
  const auto second = run("--log " + log + " --output " + again);
  REQUIRE(second.code == 0);
  CHECK(text_of(again).size() > 200);
  CHECK(std::abs(number(text_of(again), "delay_and_lag") - number(found, "delay_and_lag")) < 1e-6);
  for (const auto& file : {log, toml, again}) std::remove(file.c_str());
}

TEST_CASE("identify_robot: what its own uncertainty says is nothing is refused, and not written") {
  const std::string good = temporary("identify_good"), bad = temporary("identify_wrong"),
                    toml = temporary("toml");
  REQUIRE(run("--duration 8 --save-log " + good).code == 0);
  const Log log = read_log(good);
  const auto refused = [&](const Log& wrong, const char* words) {
    write_log(bad, wrong);
    const auto ran = run("--log " + bad + " --output " + toml);
    CAPTURE(ran.words);
    CHECK(WEXITSTATUS(ran.code) == 2);
    CHECK(ran.words.find(words) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(toml));
  };
  Log wrong = log;  // milliseconds: a delay of 0 with the exit code 0
  for (auto* entries : {&wrong.sent, &wrong.measured})
    for (auto& e : *entries) e.time *= 1000;
  refused(wrong, "are their times in seconds?");
  wrong = log;
  for (auto* entries : {&wrong.sent, &wrong.measured})
    for (auto& e : *entries)
      for (double& q : e.q) q *= 57.3;
  refused(wrong, "are its angles in radians?");
  wrong = log;  // clocks that differ by half a second
  for (auto& e : wrong.measured) e.time += 0.5;
  refused(wrong, "on the clock of its measurements?");
  wrong = log;  // commands of another run
  std::reverse(wrong.sent.begin(), wrong.sent.end());
  for (std::size_t k = 0; k < wrong.sent.size(); ++k) wrong.sent[k].time = log.sent[k].time;
  refused(wrong, "on the clock of its measurements?");
  wrong = log;  // a robot that stands
  for (auto* entries : {&wrong.sent, &wrong.measured})
    for (auto& e : *entries) e.q = log.sent.front().q;
  refused(wrong, "hardly move the robot");
  for (const auto& file : {good, bad}) std::remove(file.c_str());
}

TEST_CASE("identify_robot: neither result nor log is written onto the log that it reads") {
  const std::string line = "sent,0,1,2,3,4,5,6\n";
  for (const char* option : {" --output OUT", " --save-log OUT"})
    examples::check_own_input_is_kept(IDENTIFY_ROBOT_PROGRAM, std::string("--log IN") + option, line, 2);
}

TEST_CASE("identify_robot: a bad log is refused with its line, bad options with words") {
  const std::string file = temporary("identify_bad");
  std::ofstream(file) << "# comment\nsent,0,1,2,3,4,5,6\nmeasured,0,1,2,nan,4,5,6\n";
  CHECK_THROWS_WITH_AS((void)read_log(file), doctest::Contains(":3: not a time"),
                       skinctl::ConfigurationError);
  std::ofstream(file) << "sent,0,1,2,3,4,5\n";
  CHECK_THROWS_AS((void)read_log(file), skinctl::ConfigurationError);
  std::ofstream(file) << "sent,0,1,2,3,4,5,6,7\n";
  CHECK_THROWS_AS((void)read_log(file), skinctl::ConfigurationError);
  std::ofstream(file) << "hello\n";
  CHECK_THROWS_AS((void)read_log(file), skinctl::ConfigurationError);
  CHECK(run("--log " + file).code != 0);
  CHECK(run("--speed 1000").code != 0);
  CHECK(run("--log a --robot b").code != 0);
  CHECK(run("--help").code == 0);
  std::remove(file.c_str());
}
