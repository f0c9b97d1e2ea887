// expect: \(X_CL \* F_C\).*inner frames differ: invert, swap or express
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<Cell, Link<2>> X_CL;
  const Wrench<Link<2>, Cell> F_C;
#ifdef SKINCTL_RIGHT
  static_cast<void>(X_CL.inverse() * F_C);
#else
  static_cast<void>(X_CL * F_C);
#endif
}
