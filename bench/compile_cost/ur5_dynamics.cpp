// budget over eigen_core: 1 s 120 MB
#include <Eigen/Core>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

// Everything that a controller of a UR5 asks of the model in a cycle.
double use(const JointPosition<6>& q, const JointVelocity<6>& dq, const JointAcceleration<6>& ddq) {
  const ur5::Model robot;
  const auto poses = link_poses(robot, q);
  const auto tau = inverse_dynamics(robot, q, dq, ddq);
  const auto yr = yr_theta(robot, q, dq, dq, ddq);
  const auto gravity = gravity_torque(robot, q);
  return poses.get<5>().translation().x() + tau[0] + yr[1] + gravity[2];
}

int main() {
  return static_cast<int>(use({}, {}, {}));
}
