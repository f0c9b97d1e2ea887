// The robot that a calibration moves: a real UR5, or a simulated one in this process, over the same protocol.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "skinctl/calibration/joint_motion.hpp"

namespace simulated_ur5 {
struct ArmConfig;
}

namespace calibrate_skin {

using JointAngles6 = std::array<double, 6>;

/// What moves a robot's joints beside its axes.
struct RobotMasses {
  std::array<std::array<double, 10>, 6> bodies{};  ///< ten numbers a link, as of `inertial_parameters`
  JointAngles6 viscous{}, coulomb{}, rotor{};      ///< [N m s/rad], [N m], [kg m^2]
};

/// Somebody asked for the end: the arm has been stopped.
struct Interrupted {};

/// What became of a motion; times from its first cycle.
struct Ride {
  skinctl::JointRecording measured;  ///< as the robot reports it
  Eigen::MatrixXd torque;            ///< by the motors' currents, a row per stamp of `measured` [N m]
  skinctl::JointRecording truth;     ///< of a simulated robot as it was, of a real one the same as `measured`
};

struct ArmOptions {
  std::string host;  ///< of a real robot; empty: a simulated one
  std::uint16_t rtde_port = 0, script_port = 0,
                dashboard_port = 0;  ///< of the host; 0: as the maker has them
  bool own_clock = false;  ///< the host is a simulation: its clock need not agree with this computer's
  /// At the joints [N m/A]: of the order of what others measured for a UR5. All masses that are found scale with it.
  JointAngles6 torque_per_ampere = {12.5, 12.5, 12.5, 9, 9, 9};
  const std::atomic<bool>* stop = nullptr;  ///< set: the arm stops, and `Interrupted` is thrown
  std::function<void(const std::string&)> say = [](const std::string&) {};
  bool quiet = true;  ///< no progress line
};

/// Moves the arm by positions, 125 times a second. Throws what `adapters::ur5::Driver` throws, and
/// `std::runtime_error` where the robot is lost.
class Arm {
 public:
  /// @param simulated  what the simulated robot weighs.
  Arm(const ArmOptions& options, const RobotMasses& simulated);
  ~Arm();
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  /// Where it stands.
  [[nodiscard]] JointAngles6 here();
  /// To `q`, no joint faster than `speed` [rad/s], and still for half a second; where it then stood.
  struct Stand {
    JointAngles6 measured{}, truth{};
  };
  Stand go(const JointAngles6& q, double speed = 0.8);
  /// Along `path` [rad], from where it is at 0; a second of rest is added at both ends, and the times count from its beginning.
  [[nodiscard]] Ride follow(const std::function<skinctl::JointPoint(double)>& path, double duration);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Gives a simulated arm these masses, in the maker's links.
void weigh(simulated_ur5::ArmConfig& arm, const RobotMasses& masses);

}  // namespace calibrate_skin
