// A stiff industrial arm that we did not write: MuJoCo's dynamics under position servos.
#pragma once

#include <memory>
#include <vector>

#include "tests/support/robot_table.hpp"

namespace oracle {

/// How the servos are built.
struct ServoSettings {
  double step = 2e-4;              ///< of the simulation [s]
  double bandwidth = 250;          ///< w of every joint, critically damped [rad/s]: a lag of 2/w
  std::vector<double> rotor = {};  ///< reflected inertia of the motors [kg m^2]; empty: 1 each
};

/// An arm of revolute joints whose servos hold what they are sent: gravity compensated, PD on each joint
/// with the joint's own inertia. What pushes on it deflects it, as it would a real one.
class MujocoPlant {
 public:
  /// Throws std::runtime_error with MuJoCo's message.
  MujocoPlant(const Robot& robot, const std::vector<double>& q, const ServoSettings& settings = {});
  ~MujocoPlant();
  MujocoPlant(MujocoPlant&&) noexcept;

  /// The servos go for this from now on.
  void command(const double* q);
  /// One step under a force [N] in the base's axes on a point of a body (in its frame).
  void step(int body, const double* point, const double* force);

  [[nodiscard]] double time() const;
  [[nodiscard]] const std::vector<double>& q() const;
  [[nodiscard]] const std::vector<double>& dq() const;
  /// The servos' torques, and those of the force, at the beginning of the last step [N m].
  [[nodiscard]] const std::vector<double>& motor_torque() const;
  [[nodiscard]] const std::vector<double>& contact_torque() const;
  /// Place and velocity of a point of a body in the base, and the body's axes (row-major).
  void point(int body, const double* at, double* place, double* velocity, double* axes);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace oracle
