// expect: \(X_WT \* X_CT\).*inner frames differ: invert, swap
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Table : FrameTag {};

int main() {
  const Transform<World, Table> X_WT;
  const Transform<Cell, Table> X_CT;
#ifdef SKINCTL_RIGHT
  static_cast<void>(X_WT * X_CT.inverse());
#else
  static_cast<void>(X_WT * X_CT);
#endif
}
