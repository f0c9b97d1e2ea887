// expect: operator""_ms|literal
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  constexpr auto lag = 8ms;
#else
  constexpr auto lag = 8_ms;
#endif
  return Cycle(
      by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 4ms, .lag = lag}),
      GravityControl{});
}
