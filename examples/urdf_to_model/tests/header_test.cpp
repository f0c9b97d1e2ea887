#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "examples/support/own_input.hpp"
#include "write_model.hpp"

using namespace urdf_to_model;

namespace {

std::string robot(const std::string& name, int joints) {
  std::string text = "<robot name='" + name + "'><link name='l0'/>";
  for (int i = 1; i <= joints; ++i) {
    const std::string n = std::to_string(i), up = std::to_string(i - 1);
    text +=
        "<link name='l" + n +
        "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial></link><joint name='j" +
        n + "' type='revolute'><parent link='l" + up + "'/><child link='l" + n +
        "'/><origin rpy='1.57079632679 0 0'/><axis xyz='0 0 1'/></joint>";
  }
  return text + "</robot>";
}
bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("header: its namespace is the robot's name made an identifier, or the one asked for") {
  CHECK(has(header(skinctl::parse_urdf(robot("My arm-2", 1))), "namespace my_arm_2 {"));
  CHECK(has(header(skinctl::parse_urdf(robot("7th", 1))), "namespace robot_7th {"));
  CHECK(has(header(skinctl::parse_urdf(robot("", 1))), "namespace robot {"));
  CHECK(has(header(skinctl::parse_urdf(robot("a", 1)), {.name_space = "mine"}), "namespace mine {"));
}

TEST_CASE("header: a name cannot end the comment or the string that it stands in") {
  const auto text = header(skinctl::parse_urdf(robot("a&quot;&#10;int x;", 1)));
  CHECK(has(text, "// Robot \"a??int x;\""));
}

TEST_CASE("header: no robot's name makes a namespace that C++ does not allow") {
  const auto space = [](const std::string& name) {
    const auto text = header(skinctl::parse_urdf(robot(name, 1)));
    const auto at = text.find("\nnamespace ") + 11;
    return text.substr(at, text.find(" {", at) - at);
  };
  CHECK(space("class") == "robot_class");
  CHECK(space("Class") == "robot_class");
  CHECK(space("std") == "robot_std");
  CHECK(space("skinctl") == "robot_skinctl");
  CHECK(space("_Arm__2_") == "arm_2");
  CHECK(space("Gr\303\266\303\237e") == "gr_e");
  CHECK(space("\345\217\263\346\211\213") == "robot");
  for (const char* bad : {"class", "a::std", "1st", "a b", "_a", "a__b", "a::", "::a", "a:b", "gr\303\266"}) {
    CAPTURE(bad);
    CHECK_THROWS_AS(static_cast<void>(header(skinctl::parse_urdf(robot("a", 1)), {.name_space = bad})),
                    skinctl::ConfigurationError);
  }
  CHECK(has(header(skinctl::parse_urdf(robot("a", 1)), {.name_space = "lab::arm"}), "namespace lab::arm {"));
}

TEST_CASE("urdf_to_model: a header is not written onto its URDF") {
  std::ifstream in(URDF_TO_MODEL_CRANE);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  REQUIRE(content.size() > 1000);
  examples::check_own_input_is_kept(URDF_TO_MODEL_PROGRAM, "IN -o OUT", content, 1);
}

TEST_CASE("header: masses that the file does not give are named, and the model says so") {
  std::string text = robot("a", 1);
  const auto given = header(skinctl::parse_urdf(text));
  CHECK_FALSE(has(given, "masses_assumed"));
  text.erase(text.find("<inertial>"), text.find("</inertial>") + 11 - text.find("<inertial>"));
  const auto assumed = header(skinctl::parse_urdf(text, "a.urdf", {.total_mass = 7}));
  CHECK(has(assumed, "//   l1 7\n"));
  CHECK(has(assumed, "static constexpr bool masses_assumed = true;"));
}

TEST_CASE("header: right angles become exact when asked for") {
  const auto urdf = skinctl::parse_urdf(robot("a", 1));
  CHECK(has(header(urdf), "{{1, 0, 4.8"));
  CHECK(has(header(urdf, {.snap = 1e-9}), "{{1, 0, 0, 1, "));
}

TEST_CASE("header: limits that look like degrees are refused by joint, and taken if they are meant") {
  std::string text = robot("a", 2);
  text.insert(text.rfind("</joint>"), "<limit lower='-170' upper='170' velocity='2' effort='3'/>");
  CHECK_THROWS_WITH_AS(static_cast<void>(header(skinctl::parse_urdf(text, "arm.urdf"))),
                       "skinctl: arm.urdf:1: <joint name=\"j2\">: lower=\"-170\" rad looks like degrees; "
                       "--large-limits takes it as it is",
                       skinctl::ConfigurationError);
  CHECK(has(header(skinctl::parse_urdf(text, "arm.urdf", {.large_limits = true})), "-170"));
}

TEST_CASE("header: more than 64 joints are refused") {
  CHECK_NOTHROW(static_cast<void>(header(skinctl::parse_urdf(robot("a", 64)))));
  CHECK_THROWS_AS(static_cast<void>(header(skinctl::parse_urdf(robot("a", 65)))),
                  skinctl::ConfigurationError);
}
