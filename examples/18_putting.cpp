// 18 Putting (section 6) = ReachCartGoal [SplineOpCtrl, SkinJointCtrl, GCtrl]: reach an orange, put it into
// a box, in one sequence of skills; the controllers stay the same, so the torque is continuous.
//
//   X_o, X_b  poses of orange and box
//   drawn     height of the tool, and the largest step of a joint torque in a cycle [N m]
#include "support/skills.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const auto set = packing_skills();
  Arm arm(set);
  Curve height{"height of the tool [m]"}, steps{"largest step of a joint torque in a cycle [N m]"};
  const auto start = arm.tool();
  const Xyz<double> orange = start.origin() + Xyz<double>{-0.05, 0.2, -0.1};
  const Xyz<double> box = start.origin() + Xyz<double>{0.05, -0.1, -0.05};
  arm.ask(set.start_skill<behaviour::Reaching>(PoseGoal<Tool>{{start.axes(), orange}, 2s}));
  bool puts = false;
  JointTorque<6> last{};
  while (arm.time() < 14) {
    if (!puts && arm.memory().law.phase == SkillPhase::finished) {
      arm.ask(set.start_skill<behaviour::Putting>(PoseGoal<Tool>{{start.axes(), box}, 3s}));
      puts = true;
    }
    const auto tau = arm.step().planned.torque;
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i)
      most = std::fmax(most, arm.time() > 0.1 ? std::abs(tau[i] - last[i]) : 0);
    last = tau;
    height.add(arm.time(), arm.tool().origin().z), steps.add(arm.time(), most);
  }
  const double missed = norm(Xyz<double>(arm.tool().origin() - box));
  std::printf("put to %.2f mm\n", 1e3 * missed);
  return draw(argc, argv, "18_putting.svg", "Reaching, then Putting: the torque goes on without a jump",
              {Panel{"height of the tool [m]", {height}, {{orange.z, "orange"}, {box.z, "box"}}}.close_up(),
               steps},
              {}, arm.sketch()) ||
         !puts || missed > 0.005;
}
