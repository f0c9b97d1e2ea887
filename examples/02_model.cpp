// 02 A model: gravity torques of an arm, and the torques of a motion.
//
//   q, dq, ddq   joint positions, velocities, accelerations   J     Jacobian of the flange
//   G            torque that holds the arm                    tau   M ddq + C dq + G
#include <Eigen/Core>
#include <cstdio>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

int main() {
  const ur5::Model robot;  // all numbers are constants: zeros and ones cost no instruction
  const JointPosition<6> q{0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  const JointVelocity<6> dq{0.5, 0.2, -0.3, 0.0, 0.1, 0.4};
  const JointAcceleration<6> ddq{1.0, 0.0, 0.5, 0.0, 0.0, 0.0};

  const auto poses = link_poses(robot, q);
  const auto X_LF = Transform<Link<5>, Flange>::translation_xyz(0, 0, ur5::Description::d6);
  const Transform<Base, Flange> X_BF = poses.get<5>() * X_LF;
  const Twist<Flange, Base> V_BF = jacobian<5>(poses, X_LF) * dq;
  std::printf("flange at  %7.3f %7.3f %7.3f m\n", X_BF.origin().x, X_BF.origin().y, X_BF.origin().z);
  std::printf("moving at  %7.3f %7.3f %7.3f m/s\n", V_BF.linear.x, V_BF.linear.y, V_BF.linear.z);

  const JointTorque<6> G = gravity_torque(robot, q);
  const JointTorque<6> tau = inverse_dynamics(robot, q, dq, ddq);
  const JointAcceleration<6> back = forward_dynamics(robot, q, dq, tau).acceleration;
  std::printf("joint      G [N m]  tau [N m]  acceleration back [rad/s^2]\n");
  for (std::size_t i = 0; i < 6; ++i)
    std::printf("%zu       %10.3f %10.3f %10.3f\n", i, G[i], tau[i], back[i]);

  // The same functions for an arm whose calibration is known only at run time.
  auto links = ur5::Calibrated<>::Links{};
  for (std::size_t i = 0; i < 6; ++i) links[i] = ur5::Description::links[i];
  links[2][LinkParameter::p_x] += 0.0013;  // the upper arm is 1.3 mm shorter
  const ur5::Calibrated<> calibrated(links);
  const auto shifted = link_poses<link_bit<5>>(calibrated, q).get<5>() * X_LF;
  std::printf("calibrated flange is %.2f mm away\n",
              1000 * as_eigen(shifted.origin() - X_BF.origin()).norm());
}
