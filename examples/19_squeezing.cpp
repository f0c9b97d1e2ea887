// 19 Squeezing (section 6) = Close => ForceCart: the gripper closes, then the wrist presses on an orange.
//
//   F_d    force to press with [N]
//   k      stiffness of the orange [N/m], which a cell of the wrist touches
//   d      depth of the cell in the orange [m]; F = k d
//   drawn  the force, the depth, the gripper
#include "support/skills.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const auto cell = Arm<SkinJointControl>::cell<5>();
  const auto set = packing_skills(cell.X_LC.renamed<Link<5>, Tool>());  // the tool is the cell; z its normal
  Arm arm(set);
  const ur5::Model model;
  const auto touching = [&] {
    return Poses<ur5::Model, all_links(6)>(model, JointAngles<ur5::Model, double>(model, arm.q())).get<5>() *
           cell.X_LC;
  };
  const auto start = touching();
  const Xyz<double> n = start.axis_z();
  const double k = 1500, gap = 0.01, F_d = 8;
  Curve asked{.name = "asked", .dashed = true}, force{"measured"}, depth{"depth in the orange [mm]"},
      gripper{"gripper: 0 open, 1 closed"};
  arm.ask(set.start_skill<behaviour::Squeezing>(JointGoal<6>{home, {}}, ForceGoal<>{n, F_d}));
  while (arm.time() < 8) {
    const double d = dot(touching().origin() - start.origin(), n) - gap, F = d > 0 ? k * d : 0;
    asked.add(arm.time(), F_d), force.add(arm.time(), F), depth.add(arm.time(), 1e3 * d);
    gripper.add(arm.time(), set.commanded(arm.memory().law) == closed() ? 1 : 0);
    arm.push(cell.id, F);
    arm.step();
  }
  std::printf("%s presses with %.2f N\n", set.active(arm.memory().law).name, force.y.back());
  return draw(argc, argv, "19_squeezing.svg", "Squeezing: the gripper closes, then the wrist presses",
              {{"force [N]", {asked, force}}, depth, gripper}, {}, arm.sketch()) ||
         std::abs(force.y.back() - F_d) > 0.5;
}
