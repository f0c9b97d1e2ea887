#include "examples/simulated_ur5/scenario.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "skinctl/core/contract.hpp"

using namespace simulated_ur5;

namespace {

namespace fs = std::filesystem;

/// A folder that vanishes with the test.
struct Folder {
  Folder() : path(fs::temp_directory_path() / ("simulated_ur5_test_" + std::to_string(::getpid()))) {
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return (path / name).string();
  }
  fs::path path;
};

}  // namespace

TEST_CASE("Scenario: robot, skin and touches are read, other tables are left to others") {
  const Folder folder;
  folder.write("press.csv", "time,force\n0,0\n0.5,10\n1,0\n");
  Config config;
  read_scenario(
      folder.write(
          "s.toml",
          "[task]\nspline = 3\n"
          "[robot]\nseries = \"e-series\"\ndelay = 0.004\nlag = 0\nvelocity_limit = 2\n"
          "stiffness = 3000\nintegral_time = 0.5\nunknown_payload = 4\n"
          "home = [0, -1, -1, -1, 1, 0.5]\nprotective_force = 0\npowered = true\nseed = 9\n"
          "[skin]\ncells = \"" SKIN_FILE "\"\nproximity_distance = 0.02\nkeep_alive = 0.05\n"
          "[force_sensor]\nforce_noise = 0.2\nforce_bias = [0, 0, 4]\nforce_creep = [0.1, 0, 0]\nbias_from = "
          "3\n"
          "[motors]\ncoulomb = 2\ntorque_bias = [0, 0, 3, 0, 0, 0]\nwarming = 15\n"
          "[[touch]]\nname = \"push\"\ncell = 5\nstart = 2\nstiffness = 3000\nrepeat = 3\nperiod = 4\n"
          "[[touch]]\nlink = 3\npoint = [0, 0.05, 0.1]\nnormal = [0, 1, 0]\nprofile = \"press.csv\"\n"
          "profile_scale = 2\nimpose_force = true\nfollow = true\n"),
      config);
  const ControllerConfig& c = config.controller;
  CHECK(c.series == Series::e_series);
  CHECK(c.arm.delay == 0.004);
  CHECK(c.arm.lag == 0);
  CHECK(c.arm.stiffness[4] == 3000);
  CHECK(c.arm.integral_time == 0.5);
  CHECK(c.arm.unknown_payload == 4);
  CHECK(c.arm.velocity_limit[5] == 2);
  CHECK(c.force_sensor.force_noise == 0.2);
  CHECK(c.force_sensor.force_bias.z == 4);
  CHECK(c.force_sensor.force_creep.x == 0.1);
  CHECK(c.force_sensor.bias_from == 3);
  CHECK(c.arm.drives.coulomb[5] == 2);
  CHECK(c.arm.torque_bias[2] == 3);
  CHECK(c.arm.warming == 15);
  CHECK(c.arm.home[5] == 0.5);
  CHECK(c.protective_force == 0);
  CHECK(c.powered);
  CHECK(c.seed == 9);
  CHECK(c.cells.size() == 260);
  CHECK(c.skin.proximity_distance == 0.02);
  CHECK(c.skin.keep_alive == 50'000'000);
  REQUIRE(c.touches.size() == 4);
  CHECK(c.touches[0].name == "push #1");
  CHECK(c.touches[2].start == 10);
  CHECK(c.touches[1].cell == 5u);
  CHECK(c.touches[1].stiffness == 3000);
  CHECK(c.touches[3].link == 3);
  CHECK(c.touches[3].profile.force[1] == 10);
  CHECK(c.touches[3].impose_force);
  CHECK(c.touches[3].follow);
  CHECK_NOTHROW(Controller{c});
}

TEST_CASE("Scenario: a wrong file is refused with its line") {
  const Folder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    Config config;
    try {
      read_scenario(folder.write("bad.toml", text), config);
    } catch (const skinctl::ConfigurationError& e) {
      return e.what();
    }
    return {};
  };
  CHECK(refusal("[robot]\n\nspede = 1\n").find("bad.toml:3: robot has no key 'spede'") != std::string::npos);
  CHECK(refusal("[robot]\ndelay = \"fast\"\n").find(":2: robot.delay must be a number") != std::string::npos);
  CHECK(refusal("[robot]\nseries = \"ur10\"\n").find("\"cb3\" or \"e-series\"") != std::string::npos);
  CHECK(refusal("[robot]\nhome = [1, 2]\n").find("6 numbers") != std::string::npos);
  CHECK(refusal("robot = 3\n").find("robot must be a table") != std::string::npos);
  CHECK(refusal("[touch]\ncell = 1\n").find("[[touch]]") != std::string::npos);
  CHECK(refusal("[[touch]]\nstart = 1\n").find("touch.cell must be given") != std::string::npos);
  CHECK(refusal("[[touch]]\ncell = -1\n").find("whole number") != std::string::npos);
  CHECK(refusal("[[touch]]\ncell = 1\nstiffness = -5\n").find("stiffness") != std::string::npos);
  CHECK(refusal("[[touch]]\ncell = 1\nrepeat = 10000\n[[touch]]\ncell = 1\n").find("10000") !=
        std::string::npos);
  CHECK(refusal("[[touch]]\ncell = 1\nprofile = \"none.csv\"\n").find("no such file") != std::string::npos);
  CHECK(refusal("[skin]\ncells = \"none.json\"\n").find("none.json") != std::string::npos);
  CHECK(refusal("x = = 1\n").find("bad.toml:1") != std::string::npos);
  Config config;
  CHECK_THROWS_AS(read_scenario("/nowhere/at/all.toml", config), skinctl::ConfigurationError);
}
