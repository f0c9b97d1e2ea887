// expect: start.now. has to give its Memory
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Still {
  using Wrenches = LinkWrenches<ur5::Model, link_bit<5>>;
  struct Memory {};
#ifdef SKINCTL_RIGHT
  Memory start(Nanoseconds) const noexcept { return {}; }
#endif
  Status receive(Memory&, std::span<const CellSample>, Nanoseconds, Nanoseconds, std::size_t,
                 Wrenches*) const noexcept {
    return {};
  }
  Wrenches wrenches(const Memory&) const noexcept { return {}; }
};

auto build() {
  return Cycle(
      by_position(ur5::Model{},
                  {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 4}),
      Still{}, SkinJointControl{} + GravityControl{});
}
