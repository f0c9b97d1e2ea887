// expect: set the link.s bit in needs.jacobian_rates
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
  const State<6> state{};
  const NoTouch touch;
#ifdef SKINCTL_RIGHT
  const Quantities<ur5::Model, Needs{.jacobian_rates = link_bit<5>}> known(model, state, 0.008, touch);
#else
  const Quantities<ur5::Model, Needs{.jacobians = link_bit<5>}> known(model, state, 0.008, touch);
#endif
  static_cast<void>(known.jacobian_rate<5>());
}
