#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm = ResolverBy<Interface::torque, ur5::Model>;

auto scene(const Cycle<Arm, GravityControl>& plain, const GuardSettings<6>& one,
           const MaxToolSpeed<5>& slow) {
  return plain.with(one, slow);
}
