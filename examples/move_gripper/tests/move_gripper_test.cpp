// The program as a user runs it: what it prints and its exit codes.
#include <doctest/doctest.h>

#include <string>

#include "examples/support/run_program.hpp"

namespace {
std::string run(const std::string& arguments, int expected) {
  return examples::run_program(MOVE_GRIPPER_PROGRAM, arguments, expected);
}
bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}
}  // namespace

TEST_CASE("move_gripper: simulated grippers close on what is there") {
  const std::string hard = run("--close --force 40 --quiet", 0);
  CHECK_MESSAGE(has(hard, "holds an object with 40.0 N"), hard);
  CHECK_MESSAGE(has(hard, "50.0 mm"), hard);
  const std::string soft = run("onrobot --close --force 30 --object 0.06 --stiffness 3000 --quiet", 0);
  CHECK_MESSAGE(has(soft, "50.0 mm open, holds an object with 30.0 N"), soft);
  const std::string nothing = run("onrobot --close --object 0 --quiet", 0);
  CHECK_MESSAGE(has(nothing, "0.0 mm open\n"), nothing);
  const std::string binary = run("lacquey --close --quiet", 0);
  CHECK_MESSAGE(has(binary, "by the time it took"), binary);
}

TEST_CASE("move_gripper: what goes wrong has words and an exit code") {
  CHECK(has(run("--help", 0), "Exit codes"));
  run("--open --close", 2);
  run("robotic", 2);
  CHECK(has(run("--host 127.0.0.1 --port 1 --close", 1), "cannot reach the gripper at 127.0.0.1:1"));
  CHECK(has(run("--no-activation --close", 1), "not active"));
  CHECK(has(run("--close --grip-speed 0.02 --time 0.3 --quiet", 6), "still moving after 0.3 s: stopped"));
}
