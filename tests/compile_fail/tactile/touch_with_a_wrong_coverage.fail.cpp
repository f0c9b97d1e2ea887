// expect: coverage.memory. has to give a Coverage
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Dotted : WrappedTouch<Dotted, decltype(ur5_skin<260>())> {
  struct Memory : decltype(ur5_skin<260>())::Memory {};
  Dotted() : WrappedTouch<Dotted, decltype(ur5_skin<260>())>(ur5_skin<260>()) {}
  Status take(Memory& m, const auto& given, auto* means) const noexcept { return take_on(m, given, means); }
#ifdef SKINCTL_RIGHT
  Coverage coverage(const Memory& m) const noexcept { return wrapped().coverage(m); }
#else
  double coverage(const Memory& m) const noexcept { return wrapped().coverage(m).usable; }
#endif
};

auto build() {
  return Cycle(
      by_position(ur5::Model{},
                  {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 4}),
      Dotted{}, SkinJointControl{} + GravityControl{});
}
