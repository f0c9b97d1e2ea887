// expect: shift\(F_C, p_LC_L\).*a wrench at P along E needs p_PQ_E
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Wrench<Link<2>, Cell> F_C;
  const Offset<Link<2>, Cell, Link<2>> p_LC_L;
  [[maybe_unused]] const Transform<Cell, Link<2>> X_CL;
#ifdef SKINCTL_RIGHT
  static_cast<void>(shift(F_C, -(X_CL * p_LC_L)));
#else
  static_cast<void>(shift(F_C, p_LC_L));
#endif
}
