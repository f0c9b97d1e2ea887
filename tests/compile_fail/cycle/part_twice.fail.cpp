// expect: with: the scene has a part of this kind already: take it out first
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm = ResolverBy<Interface::position, ur5::Model>;

#ifdef SKINCTL_RIGHT
auto scene(const Cycle<Arm, GravityControl>& plain, const MaxJerk<6>& jerk, const MaxToolSpeed<5>& slow) {
  return plain.with(jerk).with(slow);
}
#else
auto scene(const Cycle<Arm, GravityControl>& plain, const MaxJerk<6>& jerk, const MaxJerk<6>& gentle) {
  return plain.with(jerk).with(gentle);
}
#endif
