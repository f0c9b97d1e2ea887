// 11 Kinesthetic Joint (Fig. 7): an arm that is led by the hand, all joints giving way.
//
//   tau    tau_skin + G(q): skin and gravity, no goal
//   F      force of a hand on the forearm [N]
//   q      joint angles [rad]
//   drawn  the force, and the distance of the tool from its start: it stays where the hand leaves it
#include "support/arm.hpp"

using namespace examples;

int main(int argc, char** argv) {
  Arm arm(SkinJointControl{} + GravityControl{});
  std::printf("%s\n", describe(arm.law()).c_str());
  Curve force{"force of the hand [N]"}, way{"tool moved by [mm]"};
  const auto cell = arm.cell<2>();
  while (arm.time() < 4) {
    const double F = arm.time() > 0.5 && arm.time() < 1.5 ? 8 : 0;
    arm.push(cell.id, F);
    arm.step();
    force.add(arm.time(), F);
    way.add(arm.time(), 1e3 * norm(Xyz<double>(arm.tool().origin() - tool_at(home).origin())));
  }
  std::printf("led by %.0f mm\n", way.y.back());
  return draw(argc, argv, "11_kinesthetic_joint.svg",
              "Kinesthetic Joint: led by the hand, it stays where it is left", {force, way},
              while_above_zero(force, "hand pushes"), arm.sketch()) ||
         way.y.back() < 20;
}
