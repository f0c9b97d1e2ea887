// 07 Impedance: a spring and a damper hold a tool; a hand leads it away, and it comes back.
//
//   tau = -J'(K e + D de) + tau_skin + G(q)
//
//   K   stiffness [N/m], [N m/rad]         D   damping [N s/m], [N m s/rad]
//   e   error of the tool's position [m]   F   force of a hand on the wrist [N]: the tool yields by F / K
#include "skinctl/control/impedance.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  using Space = OperationalSpace<6, 5>;
  const double K = 300, D = 80;
  ImpedanceSettings<Space> settings;
  settings.stiffness = {K, K, K, 30, 30, 30};
  settings.damping = {D, D, D, 8, 8, 8};
  const CartesianImpedance<6, 5> spring(Space(tool_on_flange), settings);
  Arm arm(spring + SkinCartesianControl<5, Tool, double, Yields::translation>(tool_on_flange) +
          GravityControl{});
  Curve force{"force of the hand [N]"}, way{"tool moved by [mm]"};
  const auto cell = arm.cell<5>();
  const auto start = arm.tool();
  double held = 0;
  while (arm.time() < 9) {
    const double F = arm.time() > 0.5 && arm.time() < 4.5 ? 12 : 0;
    arm.push(cell.id, F);
    arm.step();
    force.add(arm.time(), F);
    way.add(arm.time(), 1e3 * norm(Xyz<double>(arm.tool().origin() - start.origin())));
    if (F > 0) held = way.y.back();
  }
  std::printf("stood off by %.1f mm (F / K = %.1f mm), came back to %.1f mm\n", held, 12e3 / K, way.y.back());
  return draw(argc, argv, "07_impedance.svg", "A spring and a damper hold a tool that a hand leads away",
              {force, {way, {12e3 / K, "F / K"}}}, while_above_zero(force, "hand pushes"), arm.sketch()) ||
         way.y.back() > 3;
}
