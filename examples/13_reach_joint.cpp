// 13 Reach Joint Compliant (Fig. 7): joints follow a target from a sensor at 25 Hz, and give way to touch.
//
//   q_d, dq_d   the target and its velocity    tau = joint control, eqs. (8)-(14), + tau_skin + G(q)
//   F  force of a hand on the forearm [N]      drawn: the target, the shoulder, the force
#include "skinctl/control/joint_control.hpp"
#include "skinctl/skills/library.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const auto set = skill_set<behaviour::ReachJoint>(figure_7, {}, as<controller::Gravity>(GravityControl{}),
                                                    as<controller::SkinJoint>(SkinJointControl{}),
                                                    as<controller::Joint>(JointControl<6>(gains())));
  Arm arm(set);
  Curve target{"target [rad]", {}, {}}, shoulder{"shoulder [rad]", {}, {}}, force{"force [N]", {}, {}};
  const auto cell = arm.cell<2>();
  double away = 0;
  for (int k = 0; arm.time() < 8; ++k) {
    const double t = arm.time(), F = t > 4 && t < 5 ? 25 : 0;
    JointReference<6> reference{home, {}, {}};
    reference.q_d[0] = 0.2 * (1 - std::cos(t));
    reference.dq_d[0] = 0.2 * std::sin(t);
    if (k % 5 == 0) arm.ask(set.goal(reference));
    arm.push(cell.id, F);
    arm.step();
    target.add(t, reference.q_d[0]), shoulder.add(t, arm.q()[0]), force.add(t, F);
    if (t > 7) away = std::fmax(away, std::abs(arm.q()[0] - reference.q_d[0]));
  }
  std::printf("after the touch %.4f rad from the target\n", away);
  return draw(argc, argv, "13_reach_joint.svg", "Reach Joint Compliant", {target, shoulder, force}) ||
         away > 0.03;
}
