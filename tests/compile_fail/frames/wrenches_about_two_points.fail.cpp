// expect: \(F_L \+ F_C\).*other body, point or axes
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Wrench<Link<2>> F_L;
  const Wrench<Link<2>, Cell> F_C;
  [[maybe_unused]] const Transform<Link<2>, Cell> X_LC;
#ifdef SKINCTL_RIGHT
  static_cast<void>(F_L + X_LC * F_C);
#else
  static_cast<void>(F_L + F_C);
#endif
}
