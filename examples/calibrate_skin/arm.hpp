// The robot that a calibration moves: a real UR5, or a simulated one in this process, over the same protocol.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "skinctl/calibration/joint_motion.hpp"

namespace calibrate_skin {

using JointAngles6 = std::array<double, 6>;

/// Somebody asked for the end: the arm has been stopped.
struct Interrupted {};

/// What became of a motion; times from its first cycle.
struct Ride {
  skinctl::JointRecording measured;  ///< as the robot reports it
  skinctl::JointRecording truth;     ///< of a simulated robot as it was, of a real one the same as `measured`
};

struct ArmOptions {
  std::string host;                         ///< of a real robot; empty: a simulated one
  const std::atomic<bool>* stop = nullptr;  ///< set: the arm stops, and `Interrupted` is thrown
  std::function<void(const std::string&)> say = [](const std::string&) {};
  bool quiet = true;  ///< no progress line
};

/// Moves the arm by positions, 125 times a second. Throws what `adapters::ur5::Driver` throws, and
/// `std::runtime_error` where the robot is lost.
class Arm {
 public:
  explicit Arm(const ArmOptions& options);
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
  [[nodiscard]] Ride follow(const std::function<Eigen::VectorXd(double)>& path, double duration);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace calibrate_skin
