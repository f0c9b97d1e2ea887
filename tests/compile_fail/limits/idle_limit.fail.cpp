// expect: this limit limits nothing
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

struct Slow {
  using Kind = Slow;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::free;
};

auto wrong(const Cycle<Robot, GravityControl>& plain) {
  return plain.with(Slow{});
}
