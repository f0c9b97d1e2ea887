// 05 A resolver: a robot that takes nothing but positions feels like a mass with friction.
//
//   tau    torque of the laws (skin and gravity)     q^, v   the virtual robot, whose position is the command
//   T_d    delay of the robot, declared              drawn: where the arm is while a finger pushes, and after
#include <cstdio>
#include <deque>
#include <string>

// [readme:cycle]
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

using namespace skinctl;

auto make_cycle() {
  const auto arm = by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(/*acceleration*/ 15.0),
                                              .period = 8ms,
                                              .delay = 8ms,
                                              .virtual_damping = 4});  // [1/s] friction in proportion to mass
  return Cycle(arm, ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
}
// [/readme:cycle]

int main() {
  const auto cycle = make_cycle();
  State<6> measured;
  measured.q = {0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  auto memory = cycle.start(measured);
  std::deque<JointPosition<6>> under_way = {measured.q};  // the robot follows one cycle late
  const std::uint32_t cell = std::get<2>(ur5::skin_patches<260>()).placed()[30].id;

  double farthest = 0;
  for (int k = 1; k <= 375; ++k) {
    measured.time = k * 8ms;
    measured.q = under_way.front();
    under_way.pop_front();
    const float f = k > 50 && k < 120 ? 0.15f : 0.0f;  // half a second of 7 N
    const CellSample sample{.time = measured.time - 2ms, .cell = cell, .force = {f, f, f}};
    decltype(cycle)::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.samples = {&sample, 1};
    const auto out = cycle.step(memory, input);
    under_way.push_back(out.command.position);
    const double moved = measured.q[0];
    farthest = std::max(farthest, std::abs(moved));
    if (k % 15 == 0)
      std::printf("%5.2f s %s|%s*  %6.3f rad\n", 0.008 * k, f > 0 ? "push " : "     ",
                  std::string(static_cast<std::size_t>(std::min(60.0, 200 * std::abs(moved))), ' ').c_str(),
                  moved);
  }
  std::printf("joint 0 gave way by %.3f rad and came to rest\n", farthest);
  return farthest > 0.005 ? 0 : 1;
}
