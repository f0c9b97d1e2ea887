// expect: \(p_W \+ q_W\).*two points have no sum
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Point<World> p_W, q_W;
#ifdef SKINCTL_RIGHT
  static_cast<void>(p_W - q_W);
#else
  static_cast<void>(p_W + q_W);
#endif
}
