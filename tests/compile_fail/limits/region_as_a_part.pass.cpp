#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto right(const Cycle<Robot, GravityControl>& plain, const MaxToolSpeed<5>& speed) {
  return plain.with(speed);
}
