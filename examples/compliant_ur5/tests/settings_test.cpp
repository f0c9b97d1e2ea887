#include "examples/compliant_ur5/settings.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "skinctl/core/contract.hpp"

using namespace compliant_ur5;

namespace {
std::string answer(const std::string& toml) {
  const auto path = (std::filesystem::temp_directory_path() / "compliant_ur5_settings_test.toml").string();
  std::ofstream(path) << toml;
  std::string text = "accepted";
  try {
    Settings s;
    read_scenario(path, s);
  } catch (const skinctl::ConfigurationError& e) {
    text = e.what();
  }
  std::filesystem::remove(path);
  return text;
}
}  // namespace

TEST_CASE("settings: the shipped scenario is read, its task included") {
  Settings s;
  read_scenario(COMPLIANT_UR5_SCENARIO, s);
  CHECK(s.duration == 60);
  CHECK(s.task.size() == 2);
  CHECK(s.control.force_gain[1] == 70);
  CHECK(s.control.viscous == same(10));  // one number stands for six
  CHECK(s.clear.margin == 0.02);
  CHECK_FALSE(s.keep_clear);
}

TEST_CASE("settings: what is wrong is said with its line") {
  CHECK(answer("") == "accepted");
  CHECK(answer("[control]\nlambda = 10\nlambdda = 3\n").find(":3: control has no key 'lambdda'") !=
        std::string::npos);
  CHECK(answer("[control]\nlambda = \"much\"\n").find(":2: control.lambda must be a number") !=
        std::string::npos);
  CHECK(answer("[[goal]]\nat = 1\nq = [1, 2, 3]\n").find("6 numbers") != std::string::npos);
  CHECK(answer("[clear]\nmargni = 0.1\n").find(":2: clear has no key 'margni'") != std::string::npos);
  CHECK(answer("[run]\nduration = -5\n").find("-5, allowed: > 0") != std::string::npos);
  CHECK(answer("[control\n").find(":1: ") != std::string::npos);
}
