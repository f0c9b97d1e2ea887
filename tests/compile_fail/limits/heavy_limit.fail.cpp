// expect: the Memory of a limit is trivially copyable
#ifndef SKINCTL_RIGHT
#include <vector>
#endif
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

struct Slow {
  using Kind = Slow;
  struct Memory {
#ifdef SKINCTL_RIGHT
    double all = 0;
#else
    std::vector<double> all;
#endif
  };
  static constexpr Precedence precedence = Precedence::free;
  template <class Going, class Seen, class U>
  SpeedShare<double> share(Memory&, const Going&, const Seen&, const U&) const noexcept {
    return {0.5, {}};
  }
};

auto wrong(const Cycle<Robot, GravityControl>& plain) {
  return plain.with(Slow{});
}
