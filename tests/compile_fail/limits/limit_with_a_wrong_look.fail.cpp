// expect: limit: look.memory, seen, dt. has to give a Status
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

struct Slow {
  using Kind = Slow;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::free;
  template <class Seen>
#ifdef SKINCTL_RIGHT
  Status look(Memory&, const Seen&, double) const noexcept {
#else
  Status look(Memory&, const Seen&) const noexcept {
#endif
      return {};
} template <class Going, class Seen, class U>
SpeedShare<double> share(Memory&, const Going&, const Seen&, const U&) const noexcept {
  return {0.5, {}};
}
}
;

auto wrong(const Cycle<Robot, GravityControl>& plain) {
  return plain.with(Slow{});
}
