// 15 Reach Cartesian Compliant (Fig. 7): a tool follows a target on a circle, and gives way to touch.
//
//   X_BP, V  pose and velocity of the target
//   tau      operational control, eqs. (15)-(21), + tau_skin + G(q)
//   F        force of a hand on the forearm [N]
//   drawn    height of target and tool, their distance, the force
//
// Soft gains: the tool follows its target, a hand moves it aside, and it returns when the hand lets go.
#include "skinctl/control/operational_control.hpp"
#include "skinctl/skills/library.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  auto settings = operational_settings(robot);
  settings.tracking.lambda = 20, settings.tracking.K_c = 4;  // [1/s]
  const OperationalControl<6, 5> follow(tool_on_flange, settings);
  const auto set = skill_set<behaviour::ReachCartesian>(
      figure_7, {}, skill_controller<controller::Gravity>(GravityControl{}),
      skill_controller<controller::SkinJoint>(SkinJointControl{}),
      skill_controller<controller::Operational>(follow));
  Arm arm(set);
  Curve target{.name = "target", .dashed = true}, tool{"actual"}, distance{"tool from its target [mm]"},
      force{"force of the hand [N]"};
  const auto cell = arm.cell<2>();
  const auto start = arm.tool();
  double aside = 0, away = 0;
  for (int k = 0; arm.time() < 9; ++k) {
    const double t = arm.time(), F = t > 4 && t < 5 ? 20 : 0, r = 0.06;
    const Xyz<double> p = start.origin() + Xyz<double>{0, r * std::sin(t), r * (1 - std::cos(t))};
    PoseReference<Tool> reference{{start.axes(), p}, {}, {}};
    reference.V.linear = {0, r * std::cos(t), r * std::sin(t)};
    if (k == 0) reference = {start, {}, {}};
    if (k % 5 == 0) arm.ask(set.goal(reference));
    arm.push(cell.id, F);
    arm.step();
    target.add(t, p.z), tool.add(t, arm.tool().origin().z), force.add(t, F);
    const double d = norm(Xyz<double>(arm.tool().origin() - p));
    distance.add(t, 1e3 * d);
    aside = std::fmax(aside, d);
    if (t > 8) away = std::fmax(away, d);
  }
  std::printf("pushed %.0f mm aside, after the touch %.1f mm from the target\n", 1e3 * aside, 1e3 * away);
  return draw(argc, argv, "15_reach_cartesian.svg",
              "Reach Cartesian Compliant: pushed aside on its way, it returns",
              {Panel{"height of the tool [m]", {target, tool}}.close_up(), distance, force},
              while_above_zero(force, "hand pushes"), arm.sketch()) ||
         aside < 0.03 || away > 0.02;
}
