// 17 Reaching (section 6) = ReachCartGoal [SplineOpCtrl, SkinJointCtrl, GCtrl]: to an orange, gripper open.
//
//   X_o    pose of the orange
//   F      force of a hand on the forearm [N]
//   drawn  distance to the orange, the force, the phase of the skill (0 loading, 1 running, 2 finished), the gripper
#include "support/skills.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const auto set = packing_skills();
  Arm arm(set);
  std::printf("reaching = %s\n", describe(set.sum(), set.skill<behaviour::Reaching>().weights).c_str());
  Curve distance{"distance to the orange [mm]"}, force{"force of the hand [N]"},
      phase{"skill: 0 loading, 1 running, 2 finished"}, gripper{"gripper: 0 open, 1 closed"};
  const auto cell = arm.cell<2>();
  const auto start = arm.tool();
  const Xyz<double> orange = start.origin() + Xyz<double>{-0.05, 0.2, -0.1};
  arm.ask(set.start_skill<behaviour::Reaching>(PoseGoal<Tool>{{start.axes(), orange}, 3s}));
  while (arm.time() < 9) {
    const double F = arm.time() > 1.2 && arm.time() < 2.2 ? 20 : 0;
    arm.push(cell.id, F);
    arm.step();
    distance.add(arm.time(), 1e3 * norm(Xyz<double>(arm.tool().origin() - orange)));
    gripper.add(arm.time(), set.commanded(arm.memory().law) == opened() ? 0 : 1);
    force.add(arm.time(), F), phase.add(arm.time(), static_cast<double>(arm.memory().law.phase));
  }
  const bool open = set.commanded(arm.memory().law) == opened();
  std::printf("reached to %.2f mm, gripper %s\n", distance.y.back(), open ? "open" : "closed");
  return draw(argc, argv, "17_reaching.svg", "Reaching an orange: the arm waits while somebody pushes",
              {distance, force, phase, gripper}, while_above_zero(force, "hand pushes"), arm.sketch()) ||
         distance.y.back() > 5 || !open || arm.memory().law.phase != SkillPhase::finished;
}
