// 16 Reach Cartesian Goal Compliant (Fig. 7): a tool goes to a pose in a straight line; its skin gives way.
//
//   X_g    pose of the goal, reached along the spline (22)
//   tau    spline operational control + Skin Cartesian Control + G(q)
//   F      force of a hand on the wrist [N]
//   drawn  distance to the goal and from the line, the force
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  const SplineOperational reach(robot, tool_on_flange);
  Arm arm(SkinCartesianControl<5>(tool_on_flange) + reach + GravityControl{});
  Curve distance{"distance to the goal [mm]"}, off{"off the straight line [mm]"},
      force{"force of the hand [N]"};
  const auto cell = arm.cell<5>();
  const auto start = arm.tool();
  const Xyz<double> goal = start.origin() + Xyz<double>{-0.1, 0.15, 0.1};
  arm.ask({{start.axes(), goal}, 3s});
  while (arm.time() < 9) {
    const double F = arm.time() > 1.2 && arm.time() < 2.2 ? 20 : 0;
    arm.push(cell.id, F);
    arm.step();
    distance.add(arm.time(), 1e3 * norm(Xyz<double>(arm.tool().origin() - goal)));
    const Xyz<double> way = goal - start.origin(), here = arm.tool().origin() - start.origin();
    off.add(arm.time(), 1e3 * norm(Xyz<double>(here - dot(here, way) / dot(way, way) * way)));
    force.add(arm.time(), F);
  }
  std::printf("reached to %.2f mm\n", distance.y.back());
  return draw(argc, argv, "16_reach_cartesian_goal.svg",
              "Reach Cartesian Goal Compliant: pushed on its way, it reaches its goal",
              {distance, off, force}, while_above_zero(force, "hand pushes"), arm.sketch()) ||
         distance.y.back() > 5;
}
