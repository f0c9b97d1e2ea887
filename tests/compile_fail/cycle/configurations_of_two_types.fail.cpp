// expect: configurations are Cycles of one type
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build(const LinkInertia& part) {
  const RobotConfiguration<6> config{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
  const GravityControl law;
#ifdef SKINCTL_RIGHT
  return Configurations(Cycle(by_position(Loaded<ur5::Model, 5>(ur5::Model{}), config), law),
                        Cycle(by_position(Loaded<ur5::Model, 5>(ur5::Model{}, part), config), law));
#else
  return Configurations(Cycle(by_position(ur5::Model{}, config), law),
                        Cycle(by_position(Loaded<ur5::Model, 5>(ur5::Model{}, part), config), law));
#endif
}
