// 13 Reach Joint Compliant (Fig. 7): joints follow a target from a sensor at 25 Hz, and give way to touch.
//
//   q_d, dq_d  the target and its velocity
//   tau        joint control, eqs. (8)-(14), + tau_skin + G(q)
//   F          force of a hand on the forearm [N]
//   drawn      target and actual position of two joints, and the force
//
// Soft gains: the arm follows its target, a hand moves it aside, and it returns when the hand lets go.
#include "skinctl/control/joint_control.hpp"
#include "skinctl/skills/library.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  auto soft = tracking_settings(robot);
  soft.lambda = 20, soft.K_c = 4;  // [1/s]
  const auto set =
      skill_set<behaviour::ReachJoint>(figure_7, {}, skill_controller<controller::Gravity>(GravityControl{}),
                                       skill_controller<controller::SkinJoint>(SkinJointControl{}),
                                       skill_controller<controller::Joint>(JointControl<6>(soft)));
  Arm arm(set);
  Curve target_0{.name = "target", .dashed = true}, target_4 = target_0, joint_0{"actual"}, joint_4{"actual"},
                                                    force{"force of the hand [N]"};
  const auto cell = std::get<2>(ur5::skin_patches<260>()).placed()[63];  // on the side of the forearm
  double aside = 0, away = 0;
  for (int k = 0; arm.time() < 8; ++k) {
    const double t = arm.time(), F = t > 2 && t < 3 ? 25 : 0;
    JointReference<6> reference{home, {}, {}};
    reference.q_d[0] = 0.2 * (1 - std::cos(t));
    reference.dq_d[0] = 0.2 * std::sin(t);
    if (k % 5 == 0) arm.ask(set.goal(reference));
    arm.push(cell.id, F);
    arm.step();
    target_0.add(t, reference.q_d[0]), joint_0.add(t, arm.q()[0]);
    target_4.add(t, reference.q_d[4]), joint_4.add(t, arm.q()[4]), force.add(t, F);
    aside = std::fmax(aside, std::abs(arm.q()[0] - reference.q_d[0]));
    if (t > 7) away = std::fmax(away, std::abs(arm.q()[0] - reference.q_d[0]));
  }
  std::printf("pushed %.3f rad aside, after the touch %.4f rad from the target\n", aside, away);
  return draw(argc, argv, "13_reach_joint.svg", "Reach Joint Compliant: pushed aside on its way, it returns",
              {{"joint 0 [rad]", {target_0, joint_0}},
               Panel{"joint 4 [rad]", {target_4, joint_4}}.close_up(),
               force},
              while_above_zero(force, "hand pushes"), arm.sketch()) ||
         aside < 0.05 || away > 0.03;
}
