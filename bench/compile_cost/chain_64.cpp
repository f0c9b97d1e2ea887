// budget: 8 s 400 MB
// A chain of 64 joints by the loop: poses, a Jacobian, inverse and forward dynamics.
#include "skinctl/dynamics/loop_forward_dynamics.hpp"

using Snake = skinctl::CalibratedModel<skinctl::Chain<64>>;

skinctl::LoopJacobian<64> tip(const Snake& snake, const skinctl::JointPosition<64>& q) {
  const auto X = skinctl::loop_poses(snake, q);
  return skinctl::loop_jacobian<Snake>(X, 63, X.origin[63]);
}
skinctl::JointTorque<64> torque(const Snake& snake, const skinctl::JointPosition<64>& q,
                                const skinctl::JointVelocity<64>& dq,
                                const skinctl::JointAcceleration<64>& ddq) {
  return skinctl::loop_yr_theta(snake, q, dq, dq, ddq);
}
skinctl::JointAcceleration<64> acceleration(const Snake& snake, const skinctl::JointPosition<64>& q,
                                            const skinctl::JointVelocity<64>& dq,
                                            const skinctl::JointTorque<64>& tau) {
  return skinctl::loop_forward_dynamics(snake, q, dq, tau).acceleration;
}

int main() {}
