// expect: power\(F_C, V_L\).*wrench and twist differ in body, point or axes
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Wrench<Link<2>, Cell> F_C;
  const Twist<Link<2>, World, Link<2>, Link<2>> V_L;
  [[maybe_unused]] const Transform<Cell, Link<2>> X_CL;
#ifdef SKINCTL_RIGHT
  static_cast<void>(power(F_C, X_CL * V_L));
#else
  static_cast<void>(power(F_C, V_L));
#endif
}
