// Files as makers publish them: without masses, with moments that no body has, with leftovers of xacro.
//
// Promise: a maker's URDF loads, and what it lacks or has wrong is told once with the numbers
// Tried: no masses (by position and velocity; by torque refused), moments that no body has, xacro,
// velocities of 1000, soft limits, a second arm beside the chain; a UR5 without its masses: M within a
// factor of 1.7 from the total mass

#include <doctest/doctest.h>

#include <cstdlib>
#include <regex>
#include <string>

#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/io/detail/read_text.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/model/attached.hpp"
#include "skinctl/model/weightless.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/robot/spring.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;

namespace {

using Chain2 = CalibratedModel<Chain<2>>;

const std::string limit = R"(<limit lower="-2" upper="2" velocity="1" effort="50"/>)";
std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& xyz, const std::string& more = limit,
                  const std::string& type = "revolute") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin xyz=\"" + xyz + "\"/><axis xyz=\"0 0 1\"/>" + more +
         "</joint>\n";
}
std::string body(const std::string& name, const std::string& xx, const std::string& yy,
                 const std::string& zz) {
  return "<link name=\"" + name + R"("><inertial><mass value="2"/><inertia ixx=")" + xx + "\" iyy=\"" + yy +
         "\" izz=\"" + zz + "\"/></inertial></link>\n";
}
/// A stiff arm as its maker publishes it: shapes for a viewer, no masses.
std::string massless(const std::string& upper = "", const std::string& lower = "") {
  return "<robot name=\"arm\"><link name=\"base\"/><link name=\"upper\">" + upper +
         "</link><link name=\"lower\">" + lower + "</link><link name=\"flange\"/>" +
         joint("shoulder", "base", "upper", "0 0 0.3") + joint("elbow", "upper", "lower", "0.8 0 0") +
         joint("end", "lower", "flange", "0.1 0 0", "", "fixed") + "</robot>";
}
std::string shape(const std::string& geometry, const std::string& xyz) {
  return "<collision><origin xyz=\"" + xyz + "\"/><geometry>" + geometry + "</geometry></collision>";
}
bool names(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* w : words)
    if (text.find(w) == std::string::npos) {
      MESSAGE(text << " lacks " << std::string(w));
      return false;
    }
  return text.find('\n') == std::string::npos;
}
RobotConfiguration<2> configuration(const Urdf& urdf, double inertia) {
  RobotConfiguration<2> c{.limits = limits_of<2>(urdf), .period = 4ms};
  c.virtual_damping = 4.0;
  c.virtual_inertia = JointTorque<2>::constant(inertia);
  return c;
}

}  // namespace

TEST_CASE("URDF without masses: by position and velocity with virtual inertia, by torque refused in words") {
  const Urdf urdf = parse_urdf(massless(), "arm.urdf");
  REQUIRE(urdf.warnings.size() == 1);
  CHECK(names(urdf.warnings[0],
              {"arm.urdf", "\"upper\", \"lower\"", "virtual_inertia", "total_mass", "torque"}));
  const auto model = calibrated_from<Chain<2>>(urdf);
  CHECK(complaint_of([&] { return (by_position(model, configuration(urdf, 0.5))); }).empty());
  CHECK(complaint_of([&] { return (by_velocity(model, configuration(urdf, 0.5))); }).empty());
  CHECK(names(complaint_of([&] { return (by_position(model, configuration(urdf, 0))); }),
              {"joint 0", "virtual inertia 0", "> 0 kg m^2"}));
  RobotConfiguration<2> torque = configuration(urdf, 0.5);
  torque.virtual_damping = {};
  CHECK(names(complaint_of([&] { return (by_torque(model, torque)); }), {"by torque", "<inertial>"}));
  RobotConfiguration<2> spring = configuration(urdf, 0.5);
  spring.stiffness = JointTorque<2>::constant(500);
  CHECK(names(complaint_of([&] { return (by_impedance(model, spring)); }), {"by impedance"}));
  CHECK(names(complaint_of([&] { return (MotorTouch(model, MotorTouchSettings<Chain2, double>{})); }),
              {"MotorTouch", "masses"}));
}

TEST_CASE("URDF without masses: what is made of such a model is refused by torque too") {
  const auto model = calibrated_from<Chain<2>>(parse_urdf(massless(), "arm.urdf", {.total_mass = 30}));
  CHECK(has_assumed_masses(model));
  CHECK(has_assumed_masses(Weightless<Chain2>(model)));
  CHECK(has_assumed_masses(attach<1>(model, model)));
  const auto groups = [&] {
    JointLimits<1>::Values v;
    v.lower[0] = -1;
    v.upper[0] = v.velocity[0] = v.acceleration[0] = v.torque[0] = 1;
    RobotConfiguration<1> c{.limits = JointLimits<1>(v), .period = 4ms};
    RobotConfiguration<1> stiff = c;
    stiff.virtual_damping = 4.0;
    return by_groups(model, position_joints<1>(stiff), torque_joints<2>(c));
  };
  CHECK(names(complaint_of([&] { return (groups()); }), {"by torque"}));
}

TEST_CASE("URDF without masses: a total mass is spread by length, or by the volume of shapes, and told") {
  const Urdf by_length = parse_urdf(massless(), "arm.urdf", {.total_mass = 30});
  REQUIRE(by_length.assumed_masses.size() == 2);
  // Lengths 0.8 and 0.1 m, which carry 0.9 and 0.1 m.
  const double upper = 0.8 * std::cbrt(0.81), lower = 0.1 * std::cbrt(0.01);
  CHECK(by_length.assumed_masses[0].mass == doctest::Approx(30 * upper / (upper + lower)));
  CHECK(by_length.assumed_masses[0].mass + by_length.assumed_masses[1].mass == doctest::Approx(30));
  CHECK(names(by_length.warnings[0], {"30 kg", "lengths", "upper 29.1576344 kg", "torque"}));
  CHECK(by_length.joints[0].placed.inertia.c[0] == doctest::Approx(0.4));

  const std::string box = shape(R"(<box size="0.8 0.1 0.2"/>)", "0.4 0 0"),
                    ball = shape(R"(<sphere radius="0.1"/>)", "0.05 0 0"),
                    tube = shape(R"(<cylinder radius="0.05" length="0.4"/>)", "0 0 0.2");
  const Urdf by_shape = parse_urdf(massless(box, ball), "arm.urdf", {.total_mass = 30});
  const double sphere = 4.0 / 3 * 3.14159265358979 * 1e-3;
  CHECK(by_shape.assumed_masses[0].mass == doctest::Approx(30 * 0.016 / (0.016 + sphere)));
  const LinkInertia& in = by_shape.joints[0].placed.inertia;
  CHECK(in.c[0] == doctest::Approx(0.4));
  CHECK(in.xx == doctest::Approx(in.mass * (0.01 + 0.04) / 12));
  CHECK(in.yy == doctest::Approx(in.mass * (0.64 + 0.04) / 12));
  CHECK(in.zz == doctest::Approx(in.mass * (0.64 + 0.01) / 12));
  CHECK(by_shape.joints[1].placed.inertia.xx ==
        doctest::Approx(0.4 * by_shape.assumed_masses[1].mass * 0.01));
  CHECK(names(by_shape.warnings[0], {"volumes"}));
  const Urdf cylinder = parse_urdf(massless(tube, tube), "arm.urdf", {.total_mass = 8});
  CHECK(cylinder.assumed_masses[1].mass == doctest::Approx(4));
  CHECK(cylinder.joints[1].placed.inertia.xx == doctest::Approx(4 * (3 * 0.0025 + 0.16) / 12));
  CHECK(cylinder.joints[1].placed.inertia.zz == doctest::Approx(4 * 0.0025 / 2));
  // A mesh's volume is not read.
  const Urdf mesh = parse_urdf(massless(box, shape(R"(<mesh filename="a.stl"/>)", "0 0 0")), "arm.urdf",
                               {.total_mass = 30});
  CHECK(names(mesh.warnings[0], {"lengths"}));

  for (const double total : {-1.0, 1e6, std::nan("")})
    CHECK(names(complaint_of([&] { return parse_urdf(massless(), "arm.urdf", {.total_mass = total}); }),
                {"total_mass", "allowed"}));
  const std::string half = std::regex_replace(massless(), std::regex(R"(<link name="upper"></link>)"),
                                              body("upper", "1", "1", "1"));
  CHECK(parse_urdf(half, "arm.urdf", {.total_mass = 5}).assumed_masses[0].mass == doctest::Approx(3));
  CHECK(names(complaint_of([&] { return parse_urdf(half, "arm.urdf", {.total_mass = 2}); }),
              {"above the 2 kg"}));
  // A file that gives all masses: a number that cannot be meant is refused there, too.
  const std::string whole =
      std::regex_replace(half, std::regex(R"(<link name="lower"></link>)"), body("lower", "1", "1", "1"));
  for (const double total : {-1.0, 1e6, std::nan("")})
    CHECK(names(complaint_of([&] { return parse_urdf(whole, "arm.urdf", {.total_mass = total}); }),
                {"total_mass", "allowed", "4 kg"}));
  CHECK(parse_urdf(whole, "arm.urdf", {.total_mass = 5}).assumed_masses.empty());
  CHECK(parse_urdf(whole, "arm.urdf", {.total_mass = 5}).joints[1].placed.inertia.mass == 2);
}

TEST_CASE("URDF: moments that no body has are replaced by the nearest ones, with the distance") {
  const auto file = [](const std::string& first) {
    return "<robot name=\"arm\"><link name=\"base\"/>" + first + body("lower", "1", "1", "1") +
           joint("shoulder", "base", "upper", "0 0 0") + joint("elbow", "upper", "lower", "1 0 0") +
           "</robot>";
  };
  // Second moments of mass 3, 2, -1: the last becomes 0.
  const Urdf urdf = parse_urdf(file(body("upper", "1", "2", "5")), "arm.urdf");
  REQUIRE(urdf.warnings.size() == 1);
  CHECK(names(urdf.warnings[0], {"\"upper\"", "25 %", "1 kg m^2 away"}));
  const LinkInertia& in = urdf.joints[0].placed.inertia;
  CHECK(in.xx == doctest::Approx(2));
  CHECK(in.yy == doctest::Approx(3));
  CHECK(in.zz == doctest::Approx(5));
  CHECK(urdf.assumed_masses.empty());
  CHECK(complaint_of([&] { return (calibrated_from<Chain<2>>(urdf)); }).empty());
  CHECK(names(complaint_of([&] { return parse_urdf(file(body("upper", "1", "2", "-5")), "arm.urdf"); }),
              {"\"upper\"", "-5 kg m^2"}));
}

TEST_CASE("URDF: odd limits give one warning a file; soft limits are kept") {
  const std::string fast = R"(<limit lower="-2" upper="2" velocity="1000" effort="50"/>)";
  const std::string soft =
      limit + R"(<safety_controller soft_lower_limit="-1" soft_upper_limit="1.5" k_velocity="0"/>)";
  const auto file = [](const std::string& a, const std::string& b) {
    return "<robot name=\"arm\"><link name=\"base\"/>" + body("upper", "1", "1", "1") +
           body("lower", "1", "1", "1") + joint("shoulder", "base", "upper", "0 0 0", a) +
           joint("elbow", "upper", "lower", "1 0 0", b) + "</robot>";
  };
  const Urdf quick = parse_urdf(file(fast, fast), "arm.urdf");
  REQUIRE(quick.warnings.size() == 1);
  CHECK(names(quick.warnings[0], {"\"shoulder\", \"elbow\"", "1000", "large_limits"}));
  CHECK(names(complaint_of([&] { return (limits_of<2>(quick)); }), {"1000", "large_limits"}));
  const Urdf gentle = parse_urdf(file(soft, soft), "arm.urdf");
  REQUIRE(gentle.warnings.size() == 1);
  CHECK(names(gentle.warnings[0], {"soft limits", "\"elbow\"", "-1 to 1.5"}));
  CHECK(limits_of<2>(gentle).lower()[1] == -1);
  CHECK(limits_of<2>(gentle).upper()[1] == 1.5);
  const std::string none = limit + "<safety_controller k_velocity=\"10\"/>";
  const Urdf empty = parse_urdf(file(none, none), "arm.urdf");
  CHECK(empty.warnings.empty());
  CHECK(limits_of<2>(empty).lower()[0] == -2);
}

TEST_CASE("URDF: a xacro that was not expanded is called one, with the command") {
  const std::string macro =
      "<robot name=\"arm\"><xacro:include filename=\"a.xacro\"/><link name=\"base\"/>"
      "<xacro:arm prefix=\"a\"/></robot>";
  CHECK(names(complaint_of([&] { return parse_urdf(macro, "arm.urdf.xacro"); }),
              {"xacro", "`xacro arm.urdf.xacro > robot.urdf`"}));
  const std::string names_of_macros = "<robot name=\"arm\"><link name=\"${prefix}base\"/></robot>";
  CHECK(names(complaint_of([&] { return parse_urdf(names_of_macros, "arm.xacro"); }), {"`xacro arm.xacro"}));
  // One leftover in an expanded file: the rest is a robot.
  const Urdf urdf =
      parse_urdf(std::regex_replace(massless(), std::regex("</robot>"), "<xacro:camera/></robot>"),
                 "arm.urdf", {.total_mass = 1});
  CHECK(names(urdf.warnings[1], {"<xacro:camera>", "missing"}));
}

TEST_CASE("URDF: what hangs beside the chain on the fixed base is none of its business") {
  const std::string away = R"(<limit lower="0.5" upper="2" velocity="1" effort="5"/>)";
  const std::string text =
      "<robot name=\"two\"><link name=\"base\"/>" + body("upper", "1", "1", "1") +
      body("lower", "1", "1", "1") + body("other", "1", "1", "1") + body("finger", "1", "1", "1") +
      body("thumb", "1", "1", "1") + "<link name=\"drone\"/>" + joint("shoulder", "base", "upper", "0 0 0") +
      joint("elbow", "upper", "lower", "1 0 0") + joint("second", "base", "other", "0 1 0", away) +
      joint("grip", "other", "finger", "0 0 1", away) +
      joint("follow", "finger", "thumb", "0 0 1", "<mimic joint=\"elbow\"/>" + away) +
      joint("flies", "base", "drone", "0 0 0", "", "floating") + "</robot>";
  const Urdf urdf = parse_urdf(text, "two.urdf", {.tip = "lower"});
  CHECK(urdf.joints.size() == 2);
  CHECK(urdf.warnings.empty());
  // The same joints on the arm itself do matter.
  CHECK(names(complaint_of([&] { return parse_urdf(text, "two.urdf", {.tip = "other"}); }),
              {"\"grip\"", "0.5 to 2"}));
  CHECK(names(complaint_of([&] { return parse_urdf(text, "two.urdf"); }), {"\"follow\"", "<mimic>"}));
}

TEST_CASE("URDF: a UR5 whose masses are forgotten gets an inertia of the same size from its total mass") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    MESSAGE("skipped: SKINCTL_DATA_DIR is not set");
    return;
  }
  const std::string path = std::string(data) + "/ur5_model/ur5_robot.urdf";
  const Urdf maker = read_urdf(path);
  std::string text = detail::read_text(path);
  text = std::regex_replace(
      text, std::regex("<inertial>[\\s\\S]*?</inertial>|<collision>[\\s\\S]*?</collision>"), "");
  double total = 0;
  for (const UrdfJoint& j : maker.joints) total += j.placed.inertia.mass;
  const Urdf guessed = parse_urdf(text, "ur5", {.total_mass = total});
  REQUIRE(guessed.assumed_masses.size() == 6);
  const JointPosition<6> q{0.3, -1.0, 1.2, -0.4, 0.9, 0.1};
  const auto M = mass_matrix(calibrated_from<Chain<6>>(maker), q),
             E = mass_matrix(calibrated_from<Chain<6>>(guessed), q);
  for (std::size_t i = 0; i < 3; ++i) {  // a wrist's own inertia is that of its motors: virtual_inertia
    CAPTURE(i);
    MESSAGE("joint " << i << ": " << E(i, i) << " estimated, " << M(i, i) << " of the maker [kg m^2]");
    CHECK(E(i, i) > 0.4 * M(i, i));
    CHECK(E(i, i) < 2.5 * M(i, i));
  }
}
