// 05 A resolver: a robot that takes only positions feels like a mass with friction.
//
//   tau     torque of the laws (skin and gravity)
//   q^, v   state of the virtual robot, whose position is the command
//   T_d     declared delay of the robot
//   *       position of joint 0 in the printed picture, during a push and after it
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>

// [readme:cycle]
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;

auto make_cycle() {
  const auto arm = by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(/*acceleration*/ 15.0),
                                              .period = 8ms,
                                              .delay = 8ms,
                                              .virtual_damping = 4});  // [1/s] friction in proportion to mass
  return Cycle(arm, ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
}
// [/readme:cycle]

/// Simulates the drivers: an arm that follows its commands one cycle late, and a skin on which a finger
/// presses with 7 N for half a second.
struct Simulated {
  JointPosition<6> under_way{0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  State<6> state{{}, under_way, {}};
  CellSample sample{.cell = std::get<2>(ur5::skin_patches<260>()).placed()[30].id};
  int cycle = 0;

  bool wait(State<6>& measured) {
    state.time = ++cycle * 8ms;
    state.q = under_way;
    measured = state;
    return cycle <= 375;
  }
  std::span<const CellSample> poll() {
    const float f = presses() ? 0.15f : 0.0f;
    sample.time = state.time - 2ms;
    sample.force = {f, f, f};
    return {&sample, 1};
  }
  void send(const PositionCommand<6>& command) { under_way = command.position; }
  [[nodiscard]] bool presses() const { return cycle > 50 && cycle < 120; }
};

int main() {
  Simulated robot, &skin = robot;
  double farthest = 0;
  const auto show = [&] {
    const double moved = robot.state.q[0];
    farthest = std::max(farthest, std::abs(moved));
    if (robot.cycle % 15 == 0)
      std::printf("%5.2f s %s|%s*  %6.3f rad\n", 0.008 * robot.cycle, robot.presses() ? "push " : "     ",
                  std::string(static_cast<std::size_t>(std::min(60.0, 200 * std::abs(moved))), ' ').c_str(),
                  moved);
  };

  // [readme:loop]
  const auto cycle = make_cycle();
  auto memory = cycle.start(robot.state);  // takes over where the robot stands
  decltype(cycle)::Input input;
  while (robot.wait(input.measured)) {
    input.now = input.measured.time;
    input.samples = skin.poll();  // what has arrived
    const auto out = cycle.step(memory, input);
    if (out.command.valid) robot.send(out.command);
    show();
  }
  // [/readme:loop]

  std::printf("joint 0 gave way by %.3f rad and came to rest\n", farthest);
  return farthest > 0.005 ? 0 : 1;
}
