// expect: \(X_BW \* o_B\).*the obstacle is in another frame
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<Base, World> X_BW;
#ifdef SKINCTL_RIGHT
  const Obstacle<World> o_W;
  static_cast<void>(X_BW * o_W);
#else
  const Obstacle<Base> o_B;
  static_cast<void>(X_BW * o_B);
#endif
}
