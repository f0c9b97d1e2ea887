// expect: \(X_WC \* p_W\).*inner frames differ
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<World, Cell> X_WC;
  const Point<World> p_W;
#ifdef SKINCTL_RIGHT
  static_cast<void>(X_WC.inverse() * p_W);
#else
  static_cast<void>(X_WC * p_W);
#endif
}
