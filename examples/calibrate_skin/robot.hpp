// The robot that a calibration moves: a UR5, or a chain of six or seven joints from a URDF.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "skinctl/calibration/joint_recording.hpp"
#include "skinctl/calibration/sighting_types.hpp"

namespace calibrate_skin {

using JointAngles = std::vector<double>;

/// A motion that shows axes and places, within the limits of the robot.
struct PlannedMotion {
  std::function<skinctl::JointPoint(double)> path;  ///< from 0 to `duration` [s]
  double duration = 0;
  std::vector<std::string> announcements;  ///< what moves, when, how far and how fast
};

/// Joints of the elbow and behind it, and the flange, stay that far above the foot of the robot in all
/// motions [m].
inline constexpr double clearance = 0.10;

struct Robot {
  /// A link as skin files name it.
  struct Link {
    std::string name;
    skinctl::FitPose X_LinkNamed;   ///< pose of the named link in the model's, whose z is on its joint
    double radius = 0, length = 0;  ///< of the tube that stands for it in pictures [m]; 0: unknown
    double gain = 10;               ///< force gain of its skin [N]
  };
  /// A point that has to stay above the foot.
  struct Point {
    std::size_t link = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
  };

  std::string name;
  JointAngles home;                      ///< where it stands before each motion [rad]
  JointAngles lower, upper;              ///< limits of the poses in which it stands [rad]
  double acceleration = 25, jerk = 1e4;  ///< limits of the way to a pose [rad/s^2], [rad/s^3]
  std::vector<Link> links;               ///< of each joint the one that it carries
  std::vector<Point> points;
  /// Poses of the model's links in the base.
  std::function<std::vector<skinctl::FitPose>(const JointAngles&)> link_poses;
  /// Each joint alone, then all, sweeping by so much at most [rad].
  std::function<PlannedMotion(double sweep)> sweeping;
  /// Torques by the model's masses [N m]; empty: it has none, or currents say it better.
  std::function<Eigen::VectorXd(const skinctl::JointPoint&)> torque;

  [[nodiscard]] std::size_t joints() const noexcept { return home.size(); }
  /// Height of the lowest of `points` in a posture [m].
  [[nodiscard]] double lowest_point(const JointAngles& q) const;
  [[nodiscard]] double lowest_point(const PlannedMotion& motion, double step) const;
  /// Whether they keep `clearance` on the straight way of the joints between two postures.
  [[nodiscard]] bool clear_way(const JointAngles& from, const JointAngles& to) const;
  /// A motion of a minute for `find_joint_lines`, with the height that it keeps among its announcements.
  /// Throws `ConfigurationError` where none stays above the foot.
  [[nodiscard]] PlannedMotion excitation() const;
  /// Poses in which gravity turns as much as it can in every link.
  [[nodiscard]] std::vector<JointAngles> rest_poses(std::uint64_t seed) const;
  /// Sixteen at random. Throws `ConfigurationError` where hardly any stays above the foot.
  [[nodiscard]] std::vector<JointAngles> camera_poses(std::uint64_t seed) const;
  /// Transposed Jacobian of a link at its origin, in its axes: torques of a wrench.
  [[nodiscard]] Eigen::MatrixXd transposed_jacobian(std::size_t link, const JointAngles& q) const;
};

/// The UR5 of its maker, with the skin's tubes and gains of the main job.
[[nodiscard]] const Robot& ur5_robot();

/// How a robot from a URDF may move.
struct UrdfRobot {
  std::string file, tip{};  ///< the last link of the chain; empty: all joints move
  JointAngles home{};       ///< [rad]; empty: the middle between the limits
  double reach = 1.6;       ///< farthest way of a joint from home [rad]
  double acceleration = 9;  ///< [rad/s^2]; a URDF has none
  double jerk = 1e4;        ///< [rad/s^3]
};
/// Throws `ConfigurationError`, naming what it is, for a file that is no chain of six or seven turning joints
/// with limits, and for a home outside of these or too low.
[[nodiscard]] Robot robot_of(const UrdfRobot& from);

}  // namespace calibrate_skin
