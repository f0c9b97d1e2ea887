// The arm that a calibration moves: a real one over its protocol, or a simulated UR5 in this process.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>

#include "examples/calibrate_skin/calibration.hpp"
#include "skinctl/calibration/joint_recording.hpp"

namespace simulated_ur5 {
struct ArmConfig;
}

namespace calibrate_skin {

/// What moves a robot's joints beside its axes.
struct RobotMasses {
  std::array<std::array<double, 10>, 6> bodies{};  ///< ten numbers a link, as of `inertial_parameters`
  JointAngles6 viscous{}, coulomb{}, rotor{};      ///< [N m s/rad], [N m], [kg m^2]
};

/// What became of a motion; times from its first cycle.
struct Ride {
  skinctl::Nanoseconds begin{};      ///< of its times, by the robot's clock
  skinctl::JointRecording measured;  ///< as the robot reports it
  Eigen::MatrixXd torque;  ///< by a UR5's currents, a row per stamp of `measured` [N m]; of others none
  skinctl::JointRecording truth;  ///< of a simulated robot as it was, of a real one the same as `measured`
};

/// Moves the arm by positions, in each of its cycles. Throws what its driver throws, `ConfigurationError` for
/// another number of joints than the robot's, and `std::runtime_error` where the robot is lost.
class Arm {
 public:
  /// @param simulated  what the simulated robot weighs.
  Arm(const ArmOptions& options, const RobotMasses& simulated);
  ~Arm();
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  /// Where it stands.
  [[nodiscard]] JointAngles here();
  /// To `q`, no joint faster than `speed` [rad/s], and still for half a second; where it then stood.
  struct Stand {
    JointAngles measured, truth;
  };
  Stand go(const JointAngles& q, double speed = 0.8);
  /// Stays where it is told to be [s].
  void stay(double duration);
  /// Along `path` [rad], from where it is at 0; a second of rest is added at both ends, and the times count
  /// from its beginning.
  [[nodiscard]] Ride follow(const std::function<skinctl::JointPoint(double)>& path, double duration);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Gives a simulated arm these masses, in the maker's links.
void weigh(simulated_ur5::ArmConfig& arm, const RobotMasses& masses);

}  // namespace calibrate_skin
