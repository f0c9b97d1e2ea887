// budget: 4 s 400 MB
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;

// A whole scene: a UR5 with 260 cells that follows goals, gives way to touch and is commanded by position.
auto make_cycle() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, ur5_skin<260>({.force = 20}), SplineJoint(arm) + SkinJointControl{} + GravityControl{});
}

int main() {
  const auto cycle = make_cycle();
  auto memory = cycle.start(State<6>{});
  decltype(cycle)::Input input;
  return static_cast<int>(cycle.step(memory, input).command.position[0]);
}
