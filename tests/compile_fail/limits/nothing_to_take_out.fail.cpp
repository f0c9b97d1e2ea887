// expect: without: the scene has no part of this kind
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
using Robot = ResolverBy<Interface::torque, ur5::Model>;

auto right(const Cycle<Robot, GravityControl>& plain) {
  return plain.without<MotionByTorque>();
}
#else
using Robot = ResolverBy<Interface::position, ur5::Model>;

auto wrong(const Cycle<Robot, GravityControl>& plain) {
  return plain.without<SkinWatch>();
}
#endif
