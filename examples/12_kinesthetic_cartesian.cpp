// 12 Kinesthetic Cartesian (Fig. 7): the tool is led by the hand; the null space comes to rest.
//
//   tau    J' J^+' tau_skin - rate M (1 - J^+ J) dq + G(q): the skin's load on the tool, as joint torques
//   F      force of a hand on the wrist [N]
//   p, R   position [m] and axes of the tool
//   drawn  the force, the displacement and the rotation of the tool, the fastest joint
#include "skinctl/control/skin_cartesian_control.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const SkinCartesianControl<5, Tool, double, Yields::both, DampedNullSpace> skin(tool_on_flange);
  Arm arm(skin + GravityControl{});
  Curve force{"force of the hand [N]"}, way{"tool moved by [mm]"}, turn{"tool turned by [rad]"},
      rest{"fastest joint [rad/s]"};
  const auto cell = arm.cell<5>();
  const auto start = arm.tool();
  while (arm.time() < 4) {
    const double F = arm.time() > 0.5 && arm.time() < 1.5 ? 6 : 0;
    arm.push(cell.id, F);
    const auto q = arm.q();
    arm.step();
    double fastest = 0;
    for (std::size_t i = 0; i < 6; ++i) fastest = std::fmax(fastest, std::abs(arm.q()[i] - q[i]) / 0.008);
    rest.add(arm.time(), fastest);
    force.add(arm.time(), F);
    way.add(arm.time(), 1e3 * norm(Xyz<double>(arm.tool().origin() - start.origin())));
    turn.add(arm.time(), norm(log_so3(arm.tool().axes() * start.axes().transpose())));
  }
  std::printf("moved by %.0f mm, turned by %.3f rad\n", way.y.back(), turn.y.back());
  return draw(argc, argv, "12_kinesthetic_cartesian.svg",
              "Kinesthetic Cartesian: the tool is led by the hand", {force, way, turn, rest},
              while_above_zero(force, "hand pushes"), arm.sketch()) ||
         way.y.back() < 20;
}
