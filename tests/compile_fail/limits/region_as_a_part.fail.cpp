// expect: with: takes settings of limits
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto wrong(const Cycle<Robot, GravityControl>& plain, const BodyRegion& region) {
  return plain.with(region);
}
