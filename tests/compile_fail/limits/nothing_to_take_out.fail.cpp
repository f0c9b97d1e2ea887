// expect: without: the scene has no part of this kind
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto wrong(const Cycle<Robot, GravityControl>& plain) {
  return plain.without<SkinWatch>();
}
