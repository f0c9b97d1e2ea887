#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm = ResolverBy<Interface::position, ur5::Model>;

auto scene(const Cycle<Arm, GravityControl>& plain, const MaxJerk<6>& jerk, const MaxToolSpeed<5>& slow) {
  return plain.with(jerk).with(slow);
}
