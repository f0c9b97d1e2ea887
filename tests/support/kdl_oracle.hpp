// Orocos KDL behind plain arrays: an independent opinion for tests, a peer for benchmarks.
#pragma once

#include <memory>

#include "tests/support/robot_table.hpp"

namespace oracle {

/// Joints as in the table. Matrices are row-major. Every function writes all of its output.
///
/// The header shows neither KDL nor Eigen: kdl_oracle.cpp must be built for the distribution's baseline (no
/// -march), because KDL's interface exposes Eigen types whose alignment follows the instruction set. Robots
/// that are a chain go through KDL's chain solvers, with each joint about KDL's own z axis (its fastest
/// form); others through its tree solvers.
class KdlOracle {
 public:
  explicit KdlOracle(const Robot& robot);
  ~KdlOracle();
  KdlOracle(KdlOracle&&) noexcept;
  KdlOracle& operator=(KdlOracle&&) noexcept;

  [[nodiscard]] int joint_count() const;
  [[nodiscard]] int body_count() const;

  /// Pose of a body in the base: `R` 9, `p` 3.
  void pose(int body, const double* q, double* R, double* p);
  /// Jacobian of a point of a body (given in its frame), base axes, linear rows first: 6 x n.
  void jacobian(int body, const double* point, const double* q, double* J);
  /// M ddq + C dq + G.
  void inverse_dynamics(const double* q, const double* dq, const double* ddq, double* tau);
  void gravity(const double* q, double* G);
  /// C dq.
  void coriolis(const double* q, const double* dq, double* Cdq);
  /// n x n. KDL has this for chains; trees take one inverse dynamics a column.
  void mass_matrix(const double* q, double* M);
  /// Acceleration under the torque tau. Chains only: KDL has none for trees.
  void forward_dynamics(const double* q, const double* dq, const double* tau, double* ddq);

  /// dJ/dt of the last body's origin, 6 x n as `jacobian`. Chains only.
  void jacobian_rate(const double* q, const double* dq, double* dJ);
  /// Joint velocities that move the last body's origin as `twist` (linear, then angular) asks, by KDL's
  /// weighted damped least squares. Chains only.
  void damped_inverse(const double* q, const double* twist, double damping, double* dq);

  /// What KDL itself would compute for all frames of a chain, without conversion: `X` takes 12 numbers a body
  /// (R row-major, p) of the frames that stand at the next joint, `tip` at its place on the last body. For
  /// benchmarks. For a tree: the bodies' own frames.
  void peer_poses(const double* q, double* X);
  /// Jacobian of the last frame of a chain in KDL's own form; for a tree, of every leaf, one after the other.
  void peer_jacobian(const double* q, double* J);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace oracle
