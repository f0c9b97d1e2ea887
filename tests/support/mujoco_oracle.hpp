// MuJoCo behind plain arrays: an independent opinion for tests, a peer for benchmarks.
#pragma once

#include <memory>
#include <string>

#include "tests/support/robot_table.hpp"

namespace oracle {

/// The robot as MuJoCo's own model format (MJCF): no contact, no limit, no damping, no rotor inertia; numbers
/// to the last digit; each inertia on its principal axes, because MuJoCo stores it so.
std::string mjcf(const Robot& robot);

/// Joints as in the table (MuJoCo numbers depth first: the order is mapped). Matrices are row-major.
///
/// Throws std::runtime_error with MuJoCo's message for a body that MuJoCo refuses: no mass, or an inertia
/// that no body can have.
class MujocoOracle {
 public:
  explicit MujocoOracle(const Robot& robot);
  ~MujocoOracle();
  MujocoOracle(MujocoOracle&&) noexcept;
  MujocoOracle& operator=(MujocoOracle&&) noexcept;

  [[nodiscard]] int joint_count() const;
  [[nodiscard]] int body_count() const;

  /// Pose of a body in the base: `R` 9, `p` 3.
  void pose(int body, const double* q, double* R, double* p);
  /// Jacobian of a point of a body (given in its frame), base axes, linear rows first: 6 x n.
  void jacobian(int body, const double* point, const double* q, double* J);
  /// M ddq + C dq + G.
  void inverse_dynamics(const double* q, const double* dq, const double* ddq, double* tau);
  void gravity(const double* q, double* G);
  /// C dq + G.
  void bias(const double* q, const double* dq, double* result);
  /// n x n.
  void mass_matrix(const double* q, double* M);
  /// Acceleration under the torque tau.
  void forward_dynamics(const double* q, const double* dq, const double* tau, double* ddq);
  /// J M^-1 J' of a body's origin, 6 x 6, base axes, linear rows first.
  void mobility(int body, const double* q, double* A);
  /// [J]; zero of the potential: all centres of mass at the base's origin.
  void energy(const double* q, const double* dq, double& potential, double& kinetic);

  /// All bodies with one kinematics pass: `X` takes 12 numbers a body (R row-major, p). For benchmarks.
  void peer_poses(const double* q, double* X);
  /// All poses, then the Jacobian of every leaf's origin, 6 x n each, in MuJoCo's joint order. For
  /// benchmarks.
  void peer_jacobian(const double* q, double* J);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace oracle
