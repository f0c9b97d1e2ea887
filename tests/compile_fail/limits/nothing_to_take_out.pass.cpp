#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::torque, ur5::Model>;

auto right(const Cycle<Robot, GravityControl>& plain) {
  return plain.without<MotionByTorque>();
}
