// The robot's masses, friction and rotors from its currents: the motion that shows them, the fit, and what it
// is worth.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "examples/calibrate_skin/arm.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/model/topology.hpp"

namespace calibrate_skin {

/// Axes as found, and bodies where they were.
using FoundModel = skinctl::CalibratedModel<skinctl::Chain<6>>;

/// Forty seconds about `home`, all joints, within the limits of a UR5 and above its foot.
[[nodiscard]] PlannedMotion masses_motion(std::uint64_t seed = 1);

/// A point of a motion as the models take it.
struct JointState6 {
  skinctl::JointPosition<6> q;
  skinctl::JointVelocity<6> dq;
  skinctl::JointAcceleration<6> ddq;

  explicit JointState6(const skinctl::JointPoint& p) {
    for (std::size_t i = 0; i < 6; ++i)
      q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
  }
};

struct FoundMasses {
  RobotMasses masses;  ///< bodies in the links of the model
  JointAngles6 presliding{}, noise{};
  double lateness = 0;                     ///< of currents after positions [s]
  int base = 0;                            ///< numbers of the bodies that torques show
  std::vector<double> values, deviations;  ///< of these
  bool converged = false;
  /// Torques of the last fifth of the recording, which the fit has not seen: R^2 of each joint, and by the
  /// maker's bodies.
  JointAngles6 predicted{}, predicted_by_maker{};
};
/// `fit_inertia` on all but the last fifth of a recording. Throws as it does.
[[nodiscard]] FoundMasses fit_masses(const FoundModel& axes, const skinctl::JointRecording& joints,
                                     const Eigen::MatrixXd& torque);
/// The axes of `lines.json`, if all of them are known; the table is for people.
template <std::size_t N>
struct FoundAxes {
  std::optional<skinctl::CalibratedModel<skinctl::Chain<N>>> model;
  std::string table;
};
template <std::size_t N>
[[nodiscard]] FoundAxes<N> axes_of(const nlohmann::json& lines);
/// The model with these bodies.
[[nodiscard]] FoundModel with_bodies(const FoundModel& axes, const RobotMasses& masses);
/// `M(q)` with rotors.
[[nodiscard]] Eigen::Matrix<double, 6, 6> mass_of(const FoundModel& model, const RobotMasses& masses,
                                                  const JointAngles6& q);

/// A simulated UR5 of these masses follows a motion that no fit has seen by direct torque over its protocol,
/// 500 times a second: `Y_r Theta` of a model, its friction and rotors, and the same feedback. The rms of the
/// joints' errors [rad]. Throws what `adapters::ur5::Driver` throws, and `std::runtime_error` where the robot
/// is lost.
/// @param model  nullptr: the maker's bodies and axes.
[[nodiscard]] double following_error(const RobotMasses& truth, const FoundModel* model,
                                     const RobotMasses& friction);

}  // namespace calibrate_skin
