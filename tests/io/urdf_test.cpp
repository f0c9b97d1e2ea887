#include "skinctl/io/urdf.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/urdf_robots.hpp"
#include "tests/support/worst_torque.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// What `twig` below describes once its fixed joints are melted away.
struct Twig {
  static constexpr std::size_t joints = 6;
  static constexpr std::array<int, 6> parents = {-1, 0, 1, 1, -1, 4};
  static constexpr std::array<JointKind, 6> kinds = {JointKind::revolute, JointKind::prismatic,
                                                     JointKind::revolute, JointKind::revolute,
                                                     JointKind::revolute, JointKind::prismatic};
};

oracle::Robot twig(std::uint64_t seed) {
  using enum oracle::Motion;
  oracle::Random random(seed);
  oracle::Robot robot;
  const std::pair<int, oracle::Motion> shape[] = {{-1, fixed},   {0, revolute}, {1, prismatic},
                                                  {2, revolute}, {2, fixed},    {4, revolute},
                                                  {5, fixed},    {0, revolute}, {7, prismatic}};
  for (const auto& [parent, motion] : shape)
    robot.bodies.push_back(oracle::random_body(random, parent, motion));
  return robot;
}

using Matrix = std::array<double, 9>;

std::string digits(std::initializer_list<double> values) {
  std::string text;
  for (double v : values) {
    char number[40];
    std::snprintf(number, sizeof number, "%.17g ", v);
    text += number;
  }
  return text;
}
std::string origin(const Matrix& R, const std::array<double, 3>& p) {
  return "<origin xyz=\"" + digits({p[0], p[1], p[2]}) + "\" rpy=\"" +
         digits({std::atan2(R[7], R[8]), std::atan2(-R[6], std::hypot(R[0], R[3])), std::atan2(R[3], R[0])}) +
         "\"/>";
}

/// A URDF of the table in which every link's frame is turned at random against its joint, and every inertia
/// against its link.
std::string written(const oracle::Robot& robot, std::uint64_t seed) {
  using namespace oracle::table_detail;
  oracle::Random random(seed);
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"twig\">\n<link name=\"floor\"/>\n";
  std::vector<Matrix> turned;
  for (int i = 0; i < robot.body_count(); ++i) {
    const auto& b = robot.body(i);
    const Matrix A = random.rotation(), B = random.rotation();  // body from link, link from inertia
    turned.push_back(A);
    const Matrix up = b.parent < 0 ? Matrix{1, 0, 0, 0, 1, 0, 0, 0, 1}
                                   : transposed(turned[static_cast<std::size_t>(b.parent)]);
    const Matrix to = transposed(product(A, B));
    const Matrix I = product(product(to, b.inertia), transposed(to));
    const auto name = [](int k) { return k < 0 ? std::string("floor") : "link" + std::to_string(k); };
    const char* type = b.motion == oracle::Motion::fixed       ? "fixed"
                       : b.motion == oracle::Motion::prismatic ? "prismatic"
                       : i % 2 == 0                            ? "continuous"
                                                               : "revolute";
    text += "<joint name=\"joint" + std::to_string(i) + "\" type=\"" + type + "\">\n  <parent link=\"" +
            name(b.parent) + "\"/><child link=\"" + name(i) + "\"/>\n  " +
            origin(product(product(up, b.R), A), product(up, b.p)) + "\n  <axis xyz=\"" +
            digits({3 * A[6], 3 * A[7], 3 * A[8]}) +
            "\"/><limit lower=\"-1\" upper=\"+2.5\" velocity=\"3\" effort=\"4\"/>\n</joint>\n<link name=\"" +
            name(i) + "\"><inertial>" + origin(B, product(transposed(A), b.com)) + "<mass value=\"" +
            digits({b.mass}) + "\"/><inertia ixx=\"" + digits({I[0]}) + "\" ixy=\"" + digits({I[1]}) +
            "\" ixz=\"" + digits({I[2]}) + "\" iyy=\"" + digits({I[4]}) + "\" iyz=\"" + digits({I[5]}) +
            "\" izz=\"" + digits({I[8]}) + "\"/></inertial></link>\n";
  }
  return text + "</robot>\n";
}

std::string complaint(const std::string& text) {
  return complaint_of([&] { return calibrated_from<Chain<2>>(parse_urdf(text, "arm.urdf")); });
}

const std::string head = "<robot name=\"arm\">\n<link name=\"base\"/>\n";
std::string link_text(const std::string& name, const std::string& mass = "1", const std::string& zz = "1") {
  return "<link name=\"" + name + "\"><inertial><mass value=\"" + mass +
         "\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"" + zz + "\"/></inertial></link>\n";
}
std::string joint_text(const std::string& name, const std::string& parent, const std::string& child,
                       const std::string& more = "", const std::string& type = "revolute") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}
const std::string links = link_text("upper") + link_text("lower");
const std::string shoulder = joint_text("shoulder", "base", "upper"),
                  elbow = joint_text("elbow", "upper", "lower");

bool names(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* w : words)
    if (text.find(w) == std::string::npos) {
      MESSAGE(text << " lacks " << std::string(w));
      return false;
    }
  return text.size() < 300 && text.find('\n') == std::string::npos;
}

}  // namespace

TEST_CASE("URDF: any axis, any placement, fixed joints anywhere: KDL and MuJoCo agree with the table") {
  for (std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const auto table = twig(seed);
    const auto urdf = parse_urdf(written(table, 100 + seed));
    CHECK(urdf.name == "twig");
    CHECK(urdf.base == "floor");
    REQUIRE(urdf.joints.size() == 6);
    CHECK(urdf.joints[3].name == "joint5");
    CHECK(urdf.joints[1].kind == JointKind::prismatic);
    CHECK(urdf.joints[1].continuous == false);
    CHECK(urdf.joints[0].upper == 2.5);
    CHECK(urdf.joints[0].effort == 4);
    CAPTURE(seed);
    CHECK(worst_torque(calibrated_from<Twig>(urdf), oracle::without_fixed(table), 100, 3) <= 1e-12);
  }
}

TEST_CASE("URDF: frames of all links stand where KDL puts them") {
  const auto table = twig(9);
  const auto urdf = parse_urdf(written(table, 109));
  const auto model = calibrated_from<Twig>(urdf);
  oracle::KdlOracle kdl(table);
  oracle::Random random(1);
  const Motion<6> at(random);
  const auto poses = link_poses(model, at.q);
  const auto check = [&](const char* name, int body, const auto& X_BL, int carrier) {
    const auto frame = std::find_if(urdf.frames.begin(), urdf.frames.end(),
                                    [&](const UrdfFrame& f) { return f.name == name; });
    REQUIRE(frame != urdf.frames.end());
    CHECK(frame->joint == carrier);
    const Xyz<double> p = frame->p;
    const auto o = X_BL.origin() + p.x * X_BL.axis_x() + p.y * X_BL.axis_y() + p.z * X_BL.axis_z();
    double R[9], expected[3];
    kdl.pose(body, at.q.data, R, expected);
    CHECK(o.x == doctest::Approx(expected[0]).epsilon(1e-13));
    CHECK(o.y == doctest::Approx(expected[1]).epsilon(1e-13));
    CHECK(o.z == doctest::Approx(expected[2]).epsilon(1e-13));
  };
  check("link6", 6, poses.get<3>(), 3);
  check("link4", 4, poses.get<1>(), 1);
  check("link8", 8, poses.get<5>(), 5);
}

TEST_CASE("URDF: axes along the frame's own stay exact, links without a body may be fixed") {
  const auto urdf =
      parse_urdf(head + links + joint_text("shoulder", "base", "upper", "<axis xyz=\"0 2 0\"/>") +
                 joint_text("elbow", "upper", "lower", "<axis xyz=\"0 0 -1\"/>") + "<link name=\"tool\"/>" +
                 joint_text("tip", "lower", "tool", "", "fixed") + "</robot>");
  CHECK(urdf.joints[0].placed.R == Rotation<double>{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}});
  CHECK(std::isinf(urdf.joints[0].upper));
  CHECK(urdf.frames.size() == 4);
  CHECK(urdf.frames[3].name == "tool");
  const auto arm = calibrated_from<Chain<2>>(urdf);
  CHECK(arm.link(0)[LinkParameter::cos_alpha] == 0);
  CHECK(arm.link(1)[LinkParameter::cos_alpha] == 0);
}

TEST_CASE("URDF: a bad file gives one clear error that names the element") {
  const std::string good = head + links + shoulder + elbow + "</robot>";
  CHECK(complaint(good).empty());
  CHECK(names(complaint(""), {"arm.urdf", "no XML"}));
  CHECK(names(complaint("kinematics:\n  shoulder:\n    x: 0\n"), {"arm.urdf", "no XML"}));
  CHECK(names(complaint(std::string("\x7f"
                                    "ELF\0\1\2",
                                    7)),
              {"arm.urdf", "no XML"}));
  CHECK(names(complaint("<html></html>"), {"arm.urdf:1", "<html>", "no URDF"}));
  CHECK(names(complaint("<robot name=\"none\"></robot>"), {"no <link>"}));
  CHECK(names(complaint("<robot><link name=\"base\"/></robot>"), {"no joint that moves"}));
  for (std::size_t n = 0; n < good.size(); n += 7) {
    const auto text = complaint(good.substr(0, n));
    CAPTURE(text);
    CHECK(text.find("arm.urdf") != std::string::npos);
  }
  CHECK(names(complaint(std::string((std::size_t(16) << 20) + 1, ' ')), {"arm.urdf", "16 MiB"}));
  std::string deep = "<robot>";
  for (int k = 0; k < 5000; ++k) deep += "<a>";
  CHECK(names(complaint(deep), {"arm.urdf", "no XML"}));

  CHECK(names(complaint(head + link_text("upper") + "<link name=\"lower\"><inertial/></link>" + shoulder +
                        elbow + "</robot>"),
              {"arm.urdf:4", "\"lower\"", "<mass>"}));
  CHECK(names(complaint(head + link_text("upper", "-2") + link_text("lower") + shoulder + elbow + "</robot>"),
              {"arm.urdf:3", "\"upper\"", "negative mass"}));
  CHECK(names(
      complaint(head + link_text("upper", "heavy") + link_text("lower") + shoulder + elbow + "</robot>"),
      {"arm.urdf:3", "\"upper\"", "heavy", "number"}));
  CHECK(
      names(complaint(head + link_text("upper", "nan") + link_text("lower") + shoulder + elbow + "</robot>"),
            {"arm.urdf:3", "nan", "finite"}));
  CHECK(names(
      complaint(head + link_text("upper", "1", "-1") + link_text("lower") + shoulder + elbow + "</robot>"),
      {"arm.urdf:3", "\"upper\"", "moments of inertia", "-1 kg m^2"}));
  CHECK(names(complaint(head + links + shoulder + joint_text("elbow", "uper", "lower") + "</robot>"),
              {"arm.urdf:6", "\"elbow\"", "parent", "\"uper\"", "unknown"}));
  CHECK(names(complaint(head + links + shoulder + joint_text("elbow", "upper", "hand") + "</robot>"),
              {"\"elbow\"", "child", "\"hand\"", "unknown"}));
  CHECK(names(complaint(head + links + shoulder + "</robot>"), {"\"lower\"", "hangs on no joint"}));
  CHECK(names(complaint(head + links + shoulder + elbow + joint_text("back", "lower", "upper") + "</robot>"),
              {"\"back\"", "\"upper\"", "\"shoulder\""}));
  CHECK(names(complaint(head + links + joint_text("a", "upper", "lower") + joint_text("b", "lower", "upper") +
                        "</robot>"),
              {"loop", "\"b\""}));
  CHECK(names(complaint("<robot>" + links + joint_text("a", "upper", "lower") +
                        joint_text("b", "lower", "upper") + "</robot>"),
              {"loop", "\"a\""}));
  CHECK(names(complaint(head + links + link_text("upper") + "</robot>"), {"\"upper\"", "second link"}));
  CHECK(names(complaint(head + links + shoulder + joint_text("shoulder", "upper", "lower") + "</robot>"),
              {"\"shoulder\"", "second joint"}));
  CHECK(names(
      complaint(head + links + shoulder + joint_text("elbow", "upper", "lower", "", "ball") + "</robot>"),
      {"\"elbow\"", "\"ball\"", "revolute"}));
  CHECK(names(complaint(head + links + shoulder +
                        joint_text("elbow", "upper", "lower", "<mimic joint=\"shoulder\"/>") + "</robot>"),
              {"\"elbow\"", "<mimic>"}));
  CHECK(names(complaint(head + links + shoulder +
                        joint_text("elbow", "upper", "lower", "<axis xyz=\"0 0 0\"/>") + "</robot>"),
              {"\"elbow\"", "axis"}));
  CHECK(names(complaint(head + links + shoulder +
                        joint_text("elbow", "upper", "lower", "<origin xyz=\"0 0\"/>") + "</robot>"),
              {"\"elbow\"", "xyz=\"0 0\"", "3 finite numbers"}));
  CHECK(names(
      complaint(head + links + shoulder +
                joint_text("elbow", "upper", "lower", "<limit lower=\"1\" upper=\"-1\"/>") + "</robot>"),
      {"\"elbow\"", "lower limit"}));
  CHECK(names(complaint("<robot><link/></robot>"), {"<link>", "\"name\""}));
}

TEST_CASE("URDF: bodies that no density makes are a warning with the numbers, whatever their axes") {
  const auto with = [](const std::string& inertia) {
    return head + "<link name=\"upper\"><inertial><mass value=\"1\"/><inertia " + inertia +
           "/></inertial></link>\n" + link_text("lower") + shoulder + elbow + "</robot>";
  };
  // Principal moments 1, 2, 3.2 about axes halfway between x and z: the diagonal alone looks healthy.
  const std::string little = with(R"(ixx="2.1" iyy="2" izz="2.1" ixz="-1.1")");
  const Urdf urdf = parse_urdf(little, "arm.urdf");
  REQUIRE(urdf.warnings.size() == 1);
  CHECK(names(urdf.warnings[0], {"arm.urdf:3", "\"upper\"", "moments of inertia", "3.2 %"}));
  CHECK(complaint(little).empty());
  // 1, 2, 5.
  const Urdf mended = parse_urdf(with(R"(ixx="3" iyy="2" izz="3" ixz="-2")"), "arm.urdf");
  REQUIRE(mended.warnings.size() == 1);
  CHECK(
      names(mended.warnings[0], {"arm.urdf:3", "\"upper\"", "moments of inertia", "25 %", "1 kg m^2 away"}));
  CHECK(parse_urdf(head + links + shoulder + elbow + "</robot>", "arm.urdf").warnings.empty());
}

TEST_CASE("URDF: base, tip and locked joints choose a part of the robot; what is left hangs on it") {
  const FileRobot file = panda_file();
  const std::string text = file_text(file);
  // The whole arm, the hand standing open: found from the tip, or locked by name.
  const Urdf by_tip = parse_urdf(text, "panda.urdf", {.tip = "panda_hand"});
  const Urdf by_lock = parse_urdf(text, "panda.urdf", {.locked = {{"panda_finger_joint1", 0.0}}});
  REQUIRE(by_tip.joints.size() == 7);
  REQUIRE(by_tip.locked.size() == 2);
  CHECK(by_tip.locked[1].joint == "panda_finger_joint2");
  CHECK(by_tip.frames.size() == by_lock.frames.size());
  const auto a = calibrated_from<Chain<7>>(by_tip), b = calibrated_from<Chain<7>>(by_lock);
  for (std::size_t i = 0; i < 7; ++i) CHECK(a.link(i).numbers == b.link(i).numbers);
  CHECK(worst_torque(a, oracle::without_fixed(file_table(file, {{"panda_finger_joint1", 0.0}})), 10, 1) <=
        1e-12);

  // From the fourth link on; the base's own axes are the model's.
  const Urdf forearm = parse_urdf(text, "panda.urdf", {.base = "panda_link4", .tip = "panda_link6"});
  CHECK(forearm.base == "panda_link4");
  REQUIRE(forearm.joints.size() == 2);
  CHECK(forearm.joints[0].name == "panda_joint5");
  CHECK(forearm.locked.size() == 3);  // the last joint and the fingers
  const auto q = JointPosition<2>{0.4, -1.1};
  const auto X = file_poses(file, {{"panda_joint5", 0.4}, {"panda_joint6", -1.1}});
  const Eigen::Isometry3d expected = X.at("panda_link4").inverse() * X.at("panda_hand");
  const auto found =
      link_poses(calibrated_from<Chain<2>>(forearm), q).get<1>() * named_link_pose<1, "panda_hand">(forearm);
  CHECK((as_eigen(found).matrix() - expected.matrix()).cwiseAbs().maxCoeff() <= 1e-13);

  // A joint locked away from zero: the others move about it.
  const Urdf bent = parse_urdf(text, "panda.urdf", {.tip = "panda_link7", .locked = {{"panda_joint3", 0.7}}});
  REQUIRE(bent.joints.size() == 6);
  CHECK(bent.locked[0].position == 0.7);
  const auto at = file_poses(file, {{"panda_joint1", 0.2}, {"panda_joint3", 0.7}, {"panda_joint7", -0.3}});
  const auto hand =
      link_poses(calibrated_from<Chain<6>>(bent), JointPosition<6>{0.2, 0, 0, 0, 0, -0.3}).get<5>() *
      named_link_pose<5, "panda_hand">(bent);
  CHECK((as_eigen(hand).matrix() - at.at("panda_hand").matrix()).cwiseAbs().maxCoeff() <= 1e-13);
}

TEST_CASE("URDF: options that do not fit the file are refused by name") {
  const std::string text =
      head + links + shoulder + joint_text("elbow", "upper", "lower", R"(<limit lower="0.5" upper="2"/>)") +
      "<link name=\"tool\"/>" + joint_text("tip", "lower", "tool", "", "fixed") + "</robot>";
  const auto refused = [&](const UrdfOptions& options) -> std::string {
    return complaint_of([&] { return parse_urdf(text, "arm.urdf", options); });
  };
  CHECK(refused({.base = "base", .tip = "tool"}).empty());
  CHECK(names(refused({.base = "floor"}), {"arm.urdf", "\"floor\"", "base", "\"upper\""}));
  CHECK(names(refused({.tip = "hand"}), {"arm.urdf", "\"hand\"", "tip", "\"tool\""}));
  CHECK(names(refused({.base = "lower", .tip = "upper"}), {"\"upper\"", "does not hang on", "\"lower\""}));
  CHECK(names(refused({.base = "lower"}), {"no joint that moves between"}));
  CHECK(names(refused({.tip = "base"}), {"no joint that moves between"}));
  CHECK(names(refused({.tip = "upper"}), {"arm.urdf:6", "\"elbow\"", "stands at 0", "0.5 to 2", "lock"}));
  CHECK(refused({.tip = "upper", .locked = {{"elbow", 1.0}}}).empty());
  CHECK(names(refused({.locked = {{"elbow", 3.0}}}), {"\"elbow\"", "locked at 3", "0.5 to 2"}));
  CHECK(names(refused({.locked = {{"elbow", std::nan("")}}}), {"\"elbow\"", "nan", "finite"}));
  CHECK(names(refused({.locked = {{"wrist", 0.0}}}), {"\"wrist\"", "\"shoulder\"", "\"elbow\""}));
  CHECK(names(refused({.locked = {{"tip", 0.0}}}), {"\"tip\"", "fixed already"}));
}

TEST_CASE("URDF: a mimicking joint stands with the joint it follows, or the file is refused") {
  const auto text = [](const std::string& mimic) {
    return head + links + shoulder +
           joint_text("elbow", "upper", "lower", mimic + R"(<limit lower="-1" upper="1"/>)") + "</robot>";
  };
  const auto refused = [&](const std::string& mimic, const UrdfOptions& options) -> std::string {
    return complaint_of([&] { return parse_urdf(text(mimic), "arm.urdf", options); });
  };
  const std::string half = R"(<mimic joint="shoulder" multiplier="-0.5" offset="0.1"/>)";
  CHECK(names(refused(half, {}), {"arm.urdf:6", "\"elbow\"", "<mimic>", "\"shoulder\"", "Lock"}));
  CHECK(names(refused(half, {.locked = {{"shoulder", 0.4}}}), {"no joint that moves"}));
  CHECK(names(refused(half, {.locked = {{"shoulder", 4.0}}}),
              {"\"elbow\"", "\"shoulder\"", "-1.9", "-1 to 1"}));
  CHECK(names(refused(half, {.locked = {{"shoulder", 0.4}, {"elbow", 0.3}}}),
              {"\"elbow\"", "locked at 0.3", "puts it at -0.1"}));
  CHECK(refused(half, {.locked = {{"elbow", 0.3}}}).empty());
  CHECK(names(refused(R"(<mimic joint="elbow"/>)", {}), {"\"elbow\"", "mimics itself"}));
  CHECK(names(refused(R"(<mimic joint="knee"/>)", {}), {"\"elbow\"", "\"knee\"", "unknown"}));
  CHECK(names(refused(R"(<mimic/>)", {}), {"\"elbow\"", "<mimic>", "unknown"}));
  CHECK(names(refused(R"(<mimic joint="shoulder" multiplier="two"/>)", {.locked = {{"shoulder", 0.0}}}),
              {"\"elbow\"", "two", "number"}));
  const Urdf half_way = parse_urdf(
      head + links + link_text("hand") + shoulder + joint_text("elbow", "upper", "lower") +
          joint_text("wrist", "lower", "hand", R"(<mimic joint="elbow" multiplier="-0.5" offset="0.1"/>)") +
          "</robot>",
      "arm.urdf", {.locked = {{"elbow", 0.4}}});
  REQUIRE(half_way.locked.size() == 2);
  CHECK(half_way.locked[1].joint == "wrist");
  CHECK(half_way.locked[1].position == doctest::Approx(-0.1));
}

TEST_CASE("URDF: a bad inertia that cannot matter is a warning, and so is a moving link without mass") {
  const auto bad = [](const std::string& name, const char* mass, const char* size) {
    return "<link name=\"" + name + "\"><inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + size +
           "\" iyy=\"" + size + "\" izz=\"-" + size + "\"/></inertial></link>\n";
  };
  const auto warnings = [&](const std::string& text) { return parse_urdf(text, "arm.urdf").warnings; };
  // What the base and what is fixed to it weigh does not matter, whatever they say.
  const std::string fixed = joint_text("bolt", "base", "plate", "", "fixed") + shoulder + elbow + "</robot>";
  for (const std::string& plate : {bad("plate", "1", "1"), bad("plate", "-1", "1"), bad("plate", "much", "1"),
                                   std::string("<link name=\"plate\"><inertial/></link>")}) {
    const auto found = warnings(head + links + plate + fixed);
    REQUIRE(found.size() == 1);
    CHECK(names(found[0], {"arm.urdf:5", "\"plate\"", "nothing moves"}));
  }
  // A weightless mount on a moving link; a heavy one matters.
  const std::string mounted =
      joint_text("glue", "lower", "mount", "", "fixed") + shoulder + elbow + "</robot>";
  const auto found = warnings(head + links + bad("mount", "0", "1e-4") + mounted);
  REQUIRE(found.size() == 1);
  CHECK(names(found[0], {"arm.urdf:5", "\"mount\"", "moments of inertia", "do not matter"}));
  CHECK(names(complaint(head + links + bad("mount", "0", "1e-1") + mounted), {"arm.urdf:5", "\"mount\""}));
  CHECK(names(complaint(head + links + bad("mount", "-1e-9", "0") + mounted), {"\"mount\"", "negative"}));
  // The order of the parts does not matter: the bad one may be the link that the joint carries.
  const std::string swapped = head + link_text("upper") + bad("lower", "1e-6", "1e-4") + link_text("tool") +
                              joint_text("glue", "lower", "tool", "", "fixed") + shoulder + elbow +
                              "</robot>";
  CHECK(warnings(swapped).size() == 1);

  const std::string weightless =
      "<link name=\"upper\"><inertial><mass value=\"0\"/><inertia ixx=\"1\" "
      "iyy=\"1\" izz=\"1\"/></inertial></link>\n";
  const Urdf light =
      parse_urdf(head + weightless + link_text("lower") + shoulder + elbow + "</robot>", "arm.urdf");
  REQUIRE(light.assumed_masses.size() == 1);
  CHECK(light.assumed_masses[0].link == "upper");
  const std::string point =
      "<link name=\"lower\"><inertial><mass value=\"1\"/><inertia ixx=\"0\" iyy=\"0\" "
      "izz=\"0\"/></inertial></link>\n";
  const Urdf points =
      parse_urdf(head + link_text("upper") + point + shoulder + elbow + "</robot>", "arm.urdf");
  REQUIRE(points.assumed_masses.size() == 1);
  CHECK(points.assumed_masses[0].mass == 1);
  CHECK(names(points.warnings[0], {"\"lower\"", "no inertia about its axis"}));
}

TEST_CASE("URDF: limits come from the file, with a question where they look like degrees") {
  const auto with = [](const std::string& limit, const char* type = "revolute") {
    return head + links + joint_text("shoulder", "base", "upper", "<limit " + limit + "/>", type) +
           joint_text("elbow", "upper", "lower",
                      R"(<limit lower="-1" upper="2" velocity="3" effort="40"/>)") +
           "</robot>";
  };
  const auto refused = [&](const std::string& limit, const char* type = "revolute") -> std::string {
    return complaint_of([&] { return limits_of<2>(parse_urdf(with(limit, type), "arm.urdf"), 15.0); });
  };
  const std::string good = R"(lower="-2" upper="2" velocity="1" effort="50")";
  const auto limits = limits_of<2>(parse_urdf(with(good)), 15.0);
  CHECK(limits.lower()[0] == -2);
  CHECK(limits.upper()[1] == 2);
  CHECK(limits.velocity()[1] == 3);
  CHECK(limits.torque()[0] == 50);
  CHECK(limits.acceleration()[1] == 15);
  const auto endless =
      limits_of<2, float>(parse_urdf(with(R"(velocity="1" effort="50")", "continuous")), 9.0f);
  CHECK(std::isinf(endless.upper()[0]));
  CHECK(endless.hold({1000.0f, 0.0f}));

  CHECK(names(refused(R"(lower="-170" upper="170" velocity="1" effort="50")"),
              {"arm.urdf:5", "\"shoulder\"", "-170", "degrees", "large_limits"}));
  CHECK(names(refused(R"(lower="-2" upper="170" velocity="1" effort="50")"),
              {"\"shoulder\"", "170", "degrees"}));
  CHECK(names(refused(R"(velocity="180" effort="50")", "continuous"), {"\"shoulder\"", "180", "degrees"}));
  const Urdf questioned =
      parse_urdf(with(R"(lower="-170" upper="170" velocity="1" effort="50")"), "arm.urdf");
  REQUIRE(questioned.warnings.size() == 1);
  CHECK(names(questioned.warnings[0], {"arm.urdf:1", "\"shoulder\"", "-170", "degrees"}));
  const Urdf meant = parse_urdf(with(R"(lower="-170" upper="170" velocity="1" effort="50")"), "arm.urdf",
                                {.large_limits = true});
  CHECK(meant.warnings.empty());
  CHECK(limits_of<2>(meant).upper()[0] == 170);

  CHECK(names(refused(R"(lower="1" upper="1" velocity="1" effort="50")"),
              {"\"shoulder\"", "lower=\"1\"", "lock"}));
  CHECK(
      names(refused(R"(lower="-1" upper="1" velocity="0" effort="50")"), {"\"shoulder\"", "velocity=\"0\""}));
  CHECK(names(refused(R"(lower="-1" upper="1" velocity="1" effort="0")"), {"\"shoulder\"", "effort=\"0\""}));
  CHECK(names(refused(R"(lower="-1" upper="1" effort="50")"), {"\"shoulder\"", "no velocity"}));
  CHECK(names(refused(R"(lower="-1" upper="1" velocity="1")"), {"\"shoulder\"", "no effort"}));
  CHECK_THROWS_AS(static_cast<void>(limits_of<3>(parse_urdf(with(good)))), ConfigurationError);
}

TEST_CASE("URDF: whatever the bytes, a model of finite numbers or a complaint with the source") {
  const std::string good = written(twig(7), 8);
  oracle::Random random(9);
  int refused = 0, read = 0;
  for (int k = 0; k < (SKINCTL_MANY_DIGITS ? 3000 : 300); ++k) {
    std::string text = good;
    for (int changes = random.index(4); changes >= 0; --changes) {
      const std::size_t at = random.bits() % text.size(), many = 1 + random.bits() % 12;
      switch (random.index(5)) {
        case 0:
          text[at] = static_cast<char>(random.bits());
          break;
        case 1:
          text.erase(at, many);
          break;
        case 2:
          text.insert(at, 1, "<>/\"= 0-e.&"[random.bits() % 11]);
          break;
        case 3:
          text.insert(at, good.substr(random.bits() % good.size(), many));
          break;
        default:
          text[at] = static_cast<char>('0' + random.index(10));
      }
      if (text.empty()) text = " ";
    }
    try {
      UrdfOptions options;
      if (k % 3 == 1) options.tip = "link" + std::to_string(k % 9);
      if (k % 5 == 1) options.base = "link" + std::to_string(k % 4);
      if (k % 7 == 1) options.locked["joint" + std::to_string(k % 9)] = 0.5;
      const auto urdf = parse_urdf(text, "arm.urdf", options);
      const auto numbers = model_links(urdf).links;
      for (const UrdfFrame& f : urdf.frames) CHECK(rotation_error(f.R) < 1e-9);
      ++read;
      for (const auto& l : numbers)
        for (double x : l.numbers) CHECK(x - x == 0);
    } catch (const ConfigurationError& e) {
      ++refused;
      const std::string what = e.what();
      CHECK(what.find("arm.urdf") != std::string::npos);
    }
  }
  CHECK(refused > 100 * (SKINCTL_MANY_DIGITS ? 3 : 1) / 3);
  CHECK(read > 0);
}

TEST_CASE("URDF: a robot of another shape than the program's is refused by name") {
  CHECK(names(complaint(head + links + shoulder + joint_text("elbow", "base", "lower") + "</robot>"),
              {"arm.urdf:6", "\"elbow\"", "expects it on", "\"shoulder\""}));
  CHECK(names(complaint(head + links + shoulder + joint_text("elbow", "upper", "lower", "", "prismatic") +
                        "</robot>"),
              {"\"elbow\"", "turning"}));
  CHECK(names(complaint(head + link_text("upper") + shoulder + "</robot>"), {"1 joints move", "made for 2"}));
}

TEST_CASE("URDF: a file that is not there is refused") {
  CHECK_THROWS_WITH_AS(static_cast<void>(read_urdf("/no/such/robot.urdf")),
                       "skinctl: /no/such/robot.urdf: cannot be read", ConfigurationError);
}

TEST_CASE("URDF: the makers' files of the Allegro hand and the UR5") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    MESSAGE("skipped: SKINCTL_DATA_DIR is not set");
    return;
  }
  const std::string folder = data;
  const auto hand =
      calibrated_from<allegro::Tree>(read_urdf(folder + "/allegro_model/allegro_right_hand.urdf"));
  const auto shipped = allegro::right_hand();
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t p = 0; p < std::size_t(LinkParameter::count); ++p)
      CHECK(hand.link(i).numbers[p] ==
            doctest::Approx(shipped.link(i).numbers[p]).epsilon(1e-13).scale(1e-3));
  const auto warned = read_urdf(folder + "/allegro_model/allegro_right_hand.urdf").warnings;
  REQUIRE(warned.size() == 13);  // three links of each finger, four of the thumb
  CHECK(names(warned[0], {"allegro_right_hand.urdf:", "<link name=", "moments of inertia", "%"}));
  const auto other = read_urdf(folder + "/allegro_model/allegro_hand_description_right.urdf");
  CHECK(other.joints.size() == 16);

  // The palm: all of it is the makers', but for the sign of its height, which their own box of it
  // contradicts.
  tinyxml2::XMLDocument file;
  REQUIRE(file.LoadFile((folder + "/allegro_model/allegro_right_hand.urdf").c_str()) ==
          tinyxml2::XML_SUCCESS);
  const auto* link = file.RootElement()->FirstChildElement("link");
  while (!link->Attribute("name", "palm_link")) link = link->NextSiblingElement("link");
  const auto triple = [](const tinyxml2::XMLElement* element, const char* name) {
    std::istringstream in(element->Attribute(name));
    std::array<double, 3> out{};
    in >> out[0] >> out[1] >> out[2];
    return out;
  };
  const auto* inertial = link->FirstChildElement("inertial");
  const auto centre = triple(inertial->FirstChildElement("origin"), "xyz");
  const auto* box = link->FirstChildElement("collision");
  const auto middle = triple(box->FirstChildElement("origin"), "xyz");
  const auto size = triple(box->FirstChildElement("geometry")->FirstChildElement("box"), "size");
  CHECK(inertial->FirstChildElement("mass")->DoubleAttribute("value") == allegro::palm.mass);
  CHECK(inertial->FirstChildElement("inertia")->DoubleAttribute("izz") == allegro::palm.zz);
  const auto inside = [&](double z) { return std::abs(z - middle[2]) <= size[2] / 2; };
  CHECK_FALSE(inside(centre[2]));
  CHECK(inside(allegro::palm.c[2]));
  CHECK(allegro::palm.c[2] == -centre[2]);
  CHECK(allegro::palm.c[2] == middle[2]);
  CHECK(allegro::palm.c[0] == centre[0]);
  CHECK(allegro::palm.c[1] == centre[1]);

  const auto urdf = read_urdf(folder + "/ur5_model/ur5_robot.urdf");
  const auto arm = calibrated_from<Chain<6>>(urdf);
  CHECK(urdf.joints[2].name == "elbow_joint");
  CHECK(urdf.base == "world");
  CHECK(arm.link(1)[LinkParameter::mass] == 8.393);
  // Its frames lie elsewhere, its axes where the maker's table has them: at the joints' height and reach.
  const auto poses = link_poses(arm, JointPosition<6>{});
  CHECK(poses.get<1>().origin().z == doctest::Approx(0.089159));
  CHECK(std::abs(poses.get<3>().origin().x) == doctest::Approx(0.425 + 0.39225).epsilon(1e-6));
}
