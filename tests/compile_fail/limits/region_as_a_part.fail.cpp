// expect: with: takes settings of limits
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

#ifdef SKINCTL_RIGHT
auto right(const Cycle<Robot, GravityControl>& plain, const MaxToolSpeed<5>& speed) {
  return plain.with(speed);
}
#else
auto wrong(const Cycle<Robot, GravityControl>& plain, const BodyRegion& region) {
  return plain.with(region);
}
#endif
