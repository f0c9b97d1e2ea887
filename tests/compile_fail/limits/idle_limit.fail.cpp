// expect: this limit limits nothing
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

struct Slow {
  using Kind = Slow;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::free;
#ifdef SKINCTL_RIGHT
  template <class Going, class Seen, class U>
  SpeedShare<double> share(Memory&, const Going&, const Seen&, const U&) const noexcept {
    return {0.5, {}};
  }
#endif
};

auto wrong(const Cycle<Robot, GravityControl>& plain) {
  return plain.with(Slow{});
}
