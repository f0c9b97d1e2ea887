// expect: (conversion from|no viable conversion).*X_WC = X_CW
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<Cell, World> X_CW;
#ifdef SKINCTL_RIGHT
  const Transform<World, Cell> X_WC = X_CW.inverse();
#else
  const Transform<World, Cell> X_WC = X_CW;
#endif
  static_cast<void>(X_WC);
}
