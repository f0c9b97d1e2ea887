// 14 Reach Joint Goal Compliant (Fig. 7): joints go to a goal along a spline, and wait during a push.
//
//   q_g    the goal; q(t) = q_i + a1(t/t_f) (q_g - q_i), eq. (22)
//   tau    spline joint control + tau_skin + G(q)
//   F      force of a hand on the forearm [N]
//   drawn  joint 0 and its goal, the force
#include "skinctl/control/spline_joint.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  Arm arm(2.0 * SkinJointControl{} + SplineJoint(robot) + GravityControl{});
  Curve joint{"joint 0 [rad]"}, force{"force of the hand [N]"};
  const auto cell = arm.cell<2>();
  JointGoal<6> goal{home, 3s};
  goal.q_g[0] = 0.6;
  arm.ask(goal);
  while (arm.time() < 8) {
    const double F = arm.time() > 1.2 && arm.time() < 2.2 ? 25 : 0;
    arm.push(cell.id, F);
    arm.step();
    joint.add(arm.time(), arm.q()[0]), force.add(arm.time(), F);
  }
  const double missed = std::abs(arm.q()[0] - 0.6);
  std::printf("reached to %.5f rad\n", missed);
  return draw(argc, argv, "14_reach_joint_goal.svg",
              "Reach Joint Goal Compliant: it waits while somebody pushes", {{joint, {0.6, "goal"}}, force},
              while_above_zero(force, "hand pushes"), arm.sketch()) ||
         missed > 0.005;
}
