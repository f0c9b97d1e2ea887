// 08 Force control: the wrist finds a table of unknown height and presses on it, harder half-way through.
//
//   v = sat(K_p dF + K_i1 int dF + K_i2 int tanh(mu dF)),   dF = F_d - F
//
//   F_d   desired force [N]                k   stiffness of the table [N/m]
//   v     speed of the target along n      d   depth in the table [m], F = k d
//   n     direction of the press [-]
#include "skinctl/control/force_control.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const ur5::Model model;
  const auto cell = Arm<SkinJointControl>::cell<5>();
  const auto X_LC = cell.X_LC.renamed<Link<5>, Tool>();  // the tool is a cell; z its normal
  auto settings = force_settings(robot);
  settings.carried = 1;  // the table pushes the skin of the very arm that presses
  const ForceControl<6, 5> press(X_LC, settings);
  Arm arm(press + SkinJointControl{} + GravityControl{});
  const auto touching = [&] {
    return Poses<ur5::Model, all_links(6)>(model, JointAngles<ur5::Model, double>(model, arm.q())).get<5>() *
           X_LC;
  };
  const auto start = touching();
  const Xyz<double> n = start.axis_z();
  const double k = 2000, gap = 0.02;
  Curve wanted{.name = "asked", .dashed = true}, force{"measured"}, depth{"depth in the table [mm]"};
  double F_d = 6, F = 0;
  arm.ask({n, F_d});
  while (arm.time() < 10) {
    if (arm.time() > 5 && F_d < 12) arm.ask({n, F_d = 12});
    const double d = dot(touching().origin() - start.origin(), n) - gap;
    F = d > 0 ? k * d : 0;
    arm.push(cell.id, F);
    arm.step();
    wanted.add(arm.time(), F_d), force.add(arm.time(), F), depth.add(arm.time(), 1e3 * d);
  }
  std::printf("presses with %.2f N\n", F);
  return draw(argc, argv, "08_force_control.svg", "The wrist finds a table and presses on it",
              {{"force [N]", {wanted, force}}, depth}, {}, arm.sketch()) ||
         std::abs(F - F_d) > 0.5;
}
