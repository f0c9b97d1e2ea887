// 10 An energy tank: a law drives the arm only as long as there is energy to pay for it.
//
//   tau    spline joint control, eqs. (8)-(14), + tau_skin + G(q)
//   E      energy in the tank [J]: it pays for all work of the law but that of tau_skin and G(q)
//   drawn  joint 0 on its way to 0.8 rad, and E
//
// At E = 0 the arm yields to touch and brakes as before, but no longer drives.
#include "skinctl/control/spline_joint.hpp"
#include "support/arm.hpp"

using namespace examples;

template <class A>
double moved_in(A& arm, Curve& joint, Curve& energy) {
  auto goal = home;
  goal[0] += 0.8;
  arm.ask({goal, 3s});
  while (arm.time() < 6) {
    arm.step();
    joint.add(arm.time(), arm.q()[0]);
    energy.add(arm.time(), arm.memory().robot.passivity.template of<EnergyTank<>>().energy);
  }
  return arm.q()[0];
}

int main(int argc, char** argv) {
  const auto law = SplineJoint(robot) + SkinJointControl{} + GravityControl{};
  Arm rich(law, ur5_by_position(EnergyTank<>({.start = 4, .max = 5})));
  Arm poor(law, ur5_by_position(EnergyTank<>({.start = 1, .max = 5})));
  Curve q_rich{"begins with 4 J"}, E_rich = q_rich;
  Curve q_poor{.name = "begins with 1 J", .dashed = true}, E_poor = q_poor;
  const double far = moved_in(rich, q_rich, E_rich), near = moved_in(poor, q_poor, E_poor);
  std::printf("went %.3f rad with 4 J, %.3f rad with 1 J\n", far, near);
  return draw(
             argc, argv, "10_energy_tank.svg", "A law drives as long as its tank holds energy",
             {{"joint 0 [rad]", {q_rich, q_poor}, {{0.8, "goal"}}}, {"energy left [J]", {E_rich, E_poor}}}) ||
         std::abs(far - 0.8) > 0.01 || near > 0.7;
}
