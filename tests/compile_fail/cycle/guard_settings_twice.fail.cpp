// expect: with: the scene has a part of this kind already: take it out first
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm = ResolverBy<Interface::torque, ur5::Model>;

#ifdef SKINCTL_RIGHT
auto scene(const Cycle<Arm, GravityControl>& plain, const GuardSettings<6>& one,
           const MaxToolSpeed<5>& slow) {
  return plain.with(one, slow);
}
#else
auto scene(const Cycle<Arm, GravityControl>& plain, const GuardSettings<6>& one,
           const GuardSettings<6>& two) {
  return plain.with(one).with(two);
}
#endif
