// 23 A law of your own, in a sum with the library's laws.
//
//   Brake  without memory: a base class, and the torque
//   Putty  with memory: a spring whose rest position follows the arm, so the arm stays bent a little
//
// skin + brake + putty + gravity on a UR5 by position; a touch of 1 s on the upper arm.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;

// A damper of 5 N m s/rad in every joint.
struct Brake : StatelessLaw<Brake> {
  JointTorque<6> torque(const auto& known) const noexcept {
    return JointTorque<6>::generate([&](std::size_t i) { return -5.0 * known.dq()[i]; });
  }
};

// A spring [N m/rad] whose rest position approaches the arm at the rate `creep` [1/s].
struct Putty : Composable {
  struct Memory {
    JointPosition<6> rest;
  };
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  static constexpr const char* name = "putty";
  double stiffness = 60, creep = 0.5;

  Memory start(const auto& known) const noexcept { return {known.q()}; }
  JointTorque<6> torque(const Memory& memory, const auto& known) const noexcept {
    return JointTorque<6>::generate(
        [&](std::size_t i) { return stiffness * (memory.rest[i] - known.q()[i]); });
  }
  Memory advance(const Memory& memory, const auto& known, double dt, Opposition) const noexcept {
    Memory next;
    for (std::size_t i = 0; i < 6; ++i)
      next.rest[i] = memory.rest[i] + dt * creep * (known.q()[i] - memory.rest[i]);
    return next;
  }
};

int main() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  const auto cycle =
      Cycle(arm, ur5_skin<260>({.force = 20}), SkinJointControl{} + Brake{} + Putty{} + GravityControl{});

  State<6> robot;
  robot.q = {0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  const auto begin = robot.q;
  auto memory = cycle.start(robot);
  double bent = 0;
  std::printf("   t            joint 0 [rad]   skin   brake   putty [N m]\n");
  for (int k = 1; k <= 500; ++k) {
    robot.time = k * 8ms;
    const bool touched = k > 50 && k <= 175;
    const float f = touched ? 0.3F : 0;
    const CellSample sample{.time = robot.time - 1ms, .cell = 60, .force = {f, f, f}};
    decltype(cycle)::Input input;
    input.now = robot.time;
    input.measured = robot;
    input.samples = {&sample, 1};
    const auto out = cycle.step(memory, input);
    robot.q = out.command.position;  // a robot without delay
    bent = std::max(bent, std::abs(robot.q[0] - begin[0]));
    if (k % 25 == 0)
      std::printf("%5.2f %s %12.3f %10.2f %7.2f %7.2f\n", 0.008 * k, touched ? "touched" : "       ",
                  robot.q[0], out.shares[0][0], out.shares[1][0], out.shares[2][0]);
  }
  const double stays = std::abs(robot.q[0] - begin[0]);
  std::printf("bent by %.3f rad, stays bent by %.3f rad\n", bent, stays);
  return bent > 0.02 && stays > 0.05 * bent && stays < 0.9 * bent ? 0 : 1;
}
