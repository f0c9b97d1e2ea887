// budget: 4 s 400 MB
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

using namespace skinctl;

// A whole scene: a UR5 with 260 cells that gives way to touch and is commanded by position, as in the README.
auto make_cycle() {
  const auto limits = limits_of<ur5::Description>(15.0);
  return Cycle(Resolver<Interface::position, ur5::Model>(
                   ur5::Model{}, ResolverConfiguration<6>{.limits = limits, .period = 8_ms, .delay = 8_ms}),
               SkinJointControl{} + GravityControl{}, ur5_skin<260>({.force = 20}),
               Guard<Interface::position, 6>({.limits = limits, .period = 8_ms}));
}

int main() {
  const auto cycle = make_cycle();
  auto memory = cycle.start(State<6>{});
  decltype(cycle)::Input input;
  return static_cast<int>(cycle.step(memory, input).command.position[0]);
}
