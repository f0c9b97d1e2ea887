// expect: \(F_arm \+ F_wrist\).*other body, point or axes
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Wrench<Link<2>, Cell> F_arm;
  [[maybe_unused]] const Wrench<Link<3>, Cell> F_wrist;
#ifdef SKINCTL_RIGHT
  static_cast<void>(F_arm + F_arm);
#else
  static_cast<void>(F_arm + F_wrist);
#endif
}
