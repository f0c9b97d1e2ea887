// 03 From touch to torque: the joint torques of a press on one cell of 260, and the motion that follows.
//
//   f     the cell's three force readings     tau_skin   sum over cells of J_cell^T [F; 0], eq. (7)
//   w_f   newtons per unit of reading         a          acceleration of the touched point under tau_skin
#include <cstdio>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/skin_torque.hpp"

using namespace skinctl;

int main() {
  const ur5::Model robot;
  const JointPosition<6> q{0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  const auto skin = ur5_skin<260>({.force = 20});  // w_f = 20 N per unit

  // A finger presses on the middle of the forearm.
  const auto forearm = std::get<2>(ur5::skin_patches<260>()).placed();
  const auto& cell = forearm[forearm.size() / 2];
  const CellSample press{.time = 2ms, .cell = cell.id, .force = {0.2f, 0.2f, 0.2f}};

  auto memory = skin.start(0ns);
  decltype(skin)::Wrenches touch;
  skin.receive(memory, {&press, 1}, 2ms, 4ms, 1, &touch);  // the mean over the 2 ms after the press
  const JointAngles<ur5::Model, double> angles(robot, q);
  const JointTorque<6> tau_skin = skin_torque(robot, angles, touch);
  std::printf("cell %u feels 0.6 units; less the gate's 0.08 that is %.1f N\n", cell.id, 20 * (0.6 - 0.08));
  for (std::size_t i = 0; i < 6; ++i) std::printf("joint %zu  %8.3f N m\n", i, tau_skin[i]);

  // The touched point accelerates away from the finger, opposite to the cell's outward normal.
  const JointAcceleration<6> ddq = MassFactors<ur5::Model>(mass_matrix(robot, angles)).solve(tau_skin);
  const auto poses = link_poses(robot, q);
  const auto J = jacobian<2>(poses, cell.X_LC);
  const double a = dot((J * ddq).linear, (poses.get<2>() * cell.X_LC).axis_z());
  std::printf("the cell accelerates at %.2f m/s^2 along its normal: %s the finger\n", a,
              a < 0 ? "away from" : "towards");
  return a < 0 ? 0 : 1;
}
