// expect: with: the scene has a part of this kind already: take it out first
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm = ResolverBy<Interface::torque, ur5::Model>;

auto scene(const Cycle<Arm, GravityControl>& plain, const GuardSettings<6>& one,
           const GuardSettings<6>& two) {
  return plain.with(one).with(two);
}
