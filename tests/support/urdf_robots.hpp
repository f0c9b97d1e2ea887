// Small URDFs with the joint frames of real robots, and where they put their links by definition.
#pragma once

#include <Eigen/Geometry>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/support/robot_table.hpp"

namespace skinctl::testing {

/// A joint and the link that it carries, as a URDF has them. Parents come before their children.
struct FileJoint {
  std::string name, type, parent, child;
  std::array<double, 3> xyz{}, rpy{}, axis{1, 0, 0};
  std::string mimic{};  ///< the joint that it follows, one to one
};
struct FileRobot {
  std::string name, base;
  std::vector<FileJoint> joints;
};

inline constexpr double right = 1.57079632679, half_turn = 3.14159265359;  // as the files print them

/// ur5_robot.urdf of Gepetto/example-robot-data, 39aa943 (upstream ros-industrial/universal_robot, BSD).
inline FileRobot ur5_file() {
  return {
      "ur5",
      "world",
      {{"world_joint", "fixed", "world", "base_link"},
       {"shoulder_pan_joint", "revolute", "base_link", "shoulder_link", {0, 0, 0.089159}, {}, {0, 0, 1}},
       {"shoulder_lift_joint",
        "revolute",
        "shoulder_link",
        "upper_arm_link",
        {0, 0.13585, 0},
        {0, right, 0},
        {0, 1, 0}},
       {"elbow_joint", "revolute", "upper_arm_link", "forearm_link", {0, -0.1197, 0.425}, {}, {0, 1, 0}},
       {"wrist_1_joint",
        "revolute",
        "forearm_link",
        "wrist_1_link",
        {0, 0, 0.39225},
        {0, right, 0},
        {0, 1, 0}},
       {"wrist_2_joint", "revolute", "wrist_1_link", "wrist_2_link", {0, 0.093, 0}, {}, {0, 0, 1}},
       {"wrist_3_joint", "revolute", "wrist_2_link", "wrist_3_link", {0, 0, 0.09465}, {}, {0, 1, 0}},
       {"ee_fixed_joint", "fixed", "wrist_3_link", "ee_link", {0, 0.0823, 0}, {0, 0, right}},
       {"base_link-base_fixed_joint", "fixed", "base_link", "base", {}, {0, 0, -half_turn}},
       {"wrist_3_link-tool0_fixed_joint", "fixed", "wrist_3_link", "tool0", {0, 0.0823, 0}, {-right, 0, 0}}}};
}
/// z1.urdf of unitreerobotics/unitree_ros, 44a1615, robots/z1_description/xacro.
inline FileRobot z1_file() {
  return {"z1",
          "world",
          {{"base_static_joint", "fixed", "world", "link00"},
           {"joint1", "revolute", "link00", "link01", {0, 0, 0.0585}, {}, {0, 0, 1}},
           {"joint2", "revolute", "link01", "link02", {0, 0, 0.045}, {}, {0, 1, 0}},
           {"joint3", "revolute", "link02", "link03", {-0.35, 0, 0}, {}, {0, 1, 0}},
           {"joint4", "revolute", "link03", "link04", {0.218, 0, 0.057}, {}, {0, 1, 0}},
           {"joint5", "revolute", "link04", "link05", {0.07, 0, 0}, {}, {0, 0, 1}},
           {"joint6", "revolute", "link05", "link06", {0.0492, 0, 0}, {}, {1, 0, 0}}}};
}
/// kinova.urdf (Jaco j2s6s200, without its fingers) of Gepetto/example-robot-data, 4c92367.
inline FileRobot jaco_file() {
  return {"jaco",
          "base",
          {{"base_to_jaco_support", "fixed", "base", "jaco_front_hatch_support_v2"},
           {"jaco_support_to_jaco_mounting_block",
            "fixed",
            "jaco_front_hatch_support_v2",
            "jaco_mounting_block",
            {0.045, 0, -0.007626}},
           {"jaco_mounting_block_to_j2s6s200_link_base",
            "fixed",
            "jaco_mounting_block",
            "j2s6s200_link_base",
            {},
            {0, 0, right}},
           {"j2s6s200_joint_1",
            "continuous",
            "j2s6s200_link_base",
            "j2s6s200_link_1",
            {0, 0, 0.15675},
            {0, half_turn, 0},
            {0, 0, 1}},
           {"j2s6s200_joint_2",
            "revolute",
            "j2s6s200_link_1",
            "j2s6s200_link_2",
            {0, 0.0016, -0.11875},
            {-right, 0, half_turn},
            {0, 0, 1}},
           {"j2s6s200_joint_3",
            "revolute",
            "j2s6s200_link_2",
            "j2s6s200_link_3",
            {0, -0.410, 0},
            {0, half_turn, 0},
            {0, 0, 1}},
           {"j2s6s200_joint_4",
            "continuous",
            "j2s6s200_link_3",
            "j2s6s200_link_4",
            {0, 0.2073, -0.0114},
            {-right, 0, half_turn},
            {0, 0, 1}},
           {"j2s6s200_joint_5",
            "revolute",
            "j2s6s200_link_4",
            "j2s6s200_link_5",
            {0, 0, -0.10375},
            {right, 0, half_turn},
            {0, 0, 1}},
           {"j2s6s200_joint_6",
            "continuous",
            "j2s6s200_link_5",
            "j2s6s200_link_6",
            {0, 0.10375, 0},
            {-right, 0, half_turn},
            {0, 0, 1}},
           {"j2s6s200_joint_end_effector",
            "fixed",
            "j2s6s200_link_6",
            "j2s6s200_end_effector",
            {0, 0, -0.16},
            {half_turn, right, 0}}}};
}
/// go2_description.urdf of unitreerobotics/unitree_ros, 3b6a691: the four legs and the head.
inline FileRobot go2_file() {
  FileRobot robot{"go2",
                  "base",
                  {{"Head_upper_joint", "fixed", "base", "Head_upper", {0.285, 0, 0.01}},
                   {"Head_lower_joint", "fixed", "Head_upper", "Head_lower", {0.008, 0, -0.07}}}};
  for (const auto& [leg, x, y] : {std::tuple{"FL", 1, 1}, {"FR", 1, -1}, {"RL", -1, 1}, {"RR", -1, -1}}) {
    const std::string l = leg;
    robot.joints.insert(
        robot.joints.end(),
        {{l + "_hip_joint", "revolute", "base", l + "_hip", {x * 0.1934, y * 0.0465, 0}, {}, {1, 0, 0}},
         {l + "_thigh_joint", "revolute", l + "_hip", l + "_thigh", {0, y * 0.0955, 0}, {}, {0, 1, 0}},
         {l + "_calf_joint", "revolute", l + "_thigh", l + "_calf", {0, 0, -0.213}, {}, {0, 1, 0}},
         {l + "_calflower_joint", "fixed", l + "_calf", l + "_calflower", {0.020, 0, -0.148}, {0, 0.05, 0}},
         {l + "_calflower1_joint",
          "fixed",
          l + "_calflower",
          l + "_calflower1",
          {-0.01, 0, -0.04},
          {0, 0.48, 0}},
         {l + "_foot_joint", "fixed", l + "_calf", l + "_foot", {0, 0, -0.213}}});
  }
  return robot;
}
/// talos_left_arm.urdf of Gepetto/example-robot-data, 2d4cd67 (PAL Robotics): the arm from its first link on.
inline FileRobot talos_file() {
  const auto link = [](int k) { return "arm_left_" + std::to_string(k) + "_link"; };
  const auto joint = [](int k) { return "arm_left_" + std::to_string(k) + "_joint"; };
  return {"talos",
          link(1),
          {{joint(2), "revolute", link(1), link(2), {0.00493, 0.1365, 0.04673}, {}, {1, 0, 0}},
           {joint(3), "revolute", link(2), link(3), {}, {}, {0, 0, 1}},
           {joint(4), "revolute", link(3), link(4), {0.02, 0, -0.273}, {}, {0, 1, 0}},
           {joint(5), "revolute", link(4), link(5), {-0.02, 0, -0.2643}, {}, {0, 0, 1}},
           {joint(6), "revolute", link(5), link(6), {}, {}, {1, 0, 0}},
           {joint(7), "revolute", link(6), link(7), {}, {}, {0, 1, 0}}}};
}
/// panda.urdf of Gepetto/example-robot-data, 083e77e (upstream franka_description): arm and hand.
inline FileRobot panda_file() {
  const auto link = [](int k) { return "panda_link" + std::to_string(k); };
  const auto joint = [](int k) { return "panda_joint" + std::to_string(k); };
  return {
      "panda",
      link(0),
      {{joint(1), "revolute", link(0), link(1), {0, 0, 0.333}, {}, {0, 0, 1}},
       {joint(2), "revolute", link(1), link(2), {}, {-right, 0, 0}, {0, 0, 1}},
       {joint(3), "revolute", link(2), link(3), {0, -0.316, 0}, {right, 0, 0}, {0, 0, 1}},
       {joint(4), "revolute", link(3), link(4), {0.0825, 0, 0}, {right, 0, 0}, {0, 0, 1}},
       {joint(5), "revolute", link(4), link(5), {-0.0825, 0.384, 0}, {-right, 0, 0}, {0, 0, 1}},
       {joint(6), "revolute", link(5), link(6), {}, {right, 0, 0}, {0, 0, 1}},
       {joint(7), "revolute", link(6), link(7), {0.088, 0, 0}, {right, 0, 0}, {0, 0, 1}},
       {joint(8), "fixed", link(7), link(8), {0, 0, 0.107}},
       {"panda_hand_joint", "fixed", link(8), "panda_hand", {}, {0, 0, -0.785398163397}},
       {"panda_finger_joint1", "prismatic", "panda_hand", "panda_leftfinger", {0, 0, 0.0584}, {}, {0, 1, 0}},
       {"panda_finger_joint2",
        "prismatic",
        "panda_hand",
        "panda_rightfinger",
        {0, 0, 0.0584},
        {},
        {0, -1, 0},
        "panda_finger_joint1"}}};
}

/// The body of every link that a joint carries: made up, dense, the same for the file and for the oracles.
inline oracle::Body body_of(std::size_t joint) {
  oracle::Random random(100 + joint);
  return oracle::random_body(random, -1, oracle::Motion::revolute);
}

inline std::string file_text(const FileRobot& robot) {
  const auto triple = [](const char* name, const std::array<double, 3>& v) {
    char text[120];
    std::snprintf(text, sizeof text, " %s=\"%.17g %.17g %.17g\"", name, v[0], v[1], v[2]);
    return std::string(text);
  };
  std::string text = "<robot name=\"" + robot.name + "\">\n<link name=\"" + robot.base + "\"/>\n";
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const FileJoint& j = robot.joints[i];
    text += "<joint name=\"" + j.name + "\" type=\"" + j.type + "\"><origin" + triple("xyz", j.xyz) +
            triple("rpy", j.rpy) + "/><parent link=\"" + j.parent + "\"/><child link=\"" + j.child +
            "\"/><axis" + triple("xyz", j.axis) + "/>" +
            (j.mimic.empty() ? "" : "<mimic joint=\"" + j.mimic + "\"/>") +
            "<limit lower=\"-3\" upper=\"3\" velocity=\"2\" effort=\"50\"/></joint>\n";
    const oracle::Body b = body_of(i);
    char body[600];
    std::snprintf(body, sizeof body,
                  "<link name=\"%s\"><inertial><origin xyz=\"%.17g %.17g %.17g\"/><mass value=\"%.17g\"/>"
                  "<inertia ixx=\"%.17g\" iyy=\"%.17g\" izz=\"%.17g\" ixy=\"%.17g\" ixz=\"%.17g\" "
                  "iyz=\"%.17g\"/></inertial></link>\n",
                  j.child.c_str(), b.com[0], b.com[1], b.com[2], b.mass, b.inertia[0], b.inertia[4],
                  b.inertia[8], b.inertia[1], b.inertia[2], b.inertia[5]);
    text += body;
  }
  return text + "</robot>\n";
}

/// Poses of all links in the base, by definition: each joint's origin, then its motion about or along its
/// axis. `at`: positions of joints that move, by name; the others stand at 0.
inline std::map<std::string, Eigen::Isometry3d> file_poses(const FileRobot& robot,
                                                           const std::map<std::string, double>& at) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  std::map<std::string, Eigen::Isometry3d> X;
  X[robot.base] = Eigen::Isometry3d::Identity();
  for (const FileJoint& j : robot.joints) {
    const auto found = at.find(j.mimic.empty() ? j.name : j.mimic);
    const double q = found == at.end() || j.type == "fixed" ? 0 : found->second;
    const Vector3d xyz(j.xyz.data()), axis(j.axis.data());
    Eigen::Isometry3d here =
        X.at(j.parent) * Eigen::Translation3d(xyz) * AngleAxisd(j.rpy[2], Vector3d::UnitZ()) *
        AngleAxisd(j.rpy[1], Vector3d::UnitY()) * AngleAxisd(j.rpy[0], Vector3d::UnitX());
    if (j.type == "prismatic") {
      here.translate(q * axis.normalized());
    } else {
      here.rotate(AngleAxisd(q, axis.normalized()));
    }
    X[j.child] = here;
  }
  return X;
}

/// The same robot for the oracles: frames with z on the joints, turned there by Eigen. Joints of `standing`
/// are fixed where it says.
inline oracle::Robot file_table(const FileRobot& robot, const std::map<std::string, double>& standing) {
  using Eigen::Matrix3d, Eigen::Vector3d;
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const auto zero = file_poses(robot, standing);
  std::map<std::string, int> body{{robot.base, -1}};
  std::map<std::string, Eigen::Isometry3d> frame{{robot.base, Eigen::Isometry3d::Identity()}};
  oracle::Robot table;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const FileJoint& j = robot.joints[i];
    const bool stands = j.type == "fixed" || standing.count(j.name) != 0 || standing.count(j.mimic) != 0;
    const Matrix3d turn = stands
                              ? Matrix3d(Matrix3d::Identity())
                              : Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(j.axis.data()))
                                    .toRotationMatrix();
    Eigen::Isometry3d X = zero.at(j.child);
    X.linear() = X.linear() * turn;
    const Eigen::Isometry3d in_parent = frame.at(j.parent).inverse() * X;
    oracle::Body b = body_of(i);
    const Vector3d com = turn.transpose() * Vector3d(b.com.data());
    const Matrix3d I = turn.transpose() * Eigen::Map<const Rows>(b.inertia.data()) * turn;
    Eigen::Map<Rows>(b.R.data()) = in_parent.linear();
    Eigen::Map<Vector3d>(b.p.data()) = in_parent.translation();
    Eigen::Map<Vector3d>(b.com.data()) = com;
    Eigen::Map<Rows>(b.inertia.data()) = I;
    b.parent = body.at(j.parent);
    b.motion = stands                  ? oracle::Motion::fixed
               : j.type == "prismatic" ? oracle::Motion::prismatic
                                       : oracle::Motion::revolute;
    body[j.child] = table.body_count();
    frame[j.child] = X;
    table.bodies.push_back(b);
  }
  return table;
}

}  // namespace skinctl::testing
