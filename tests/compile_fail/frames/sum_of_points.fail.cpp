// expect: \(p_W \+ q_W\).*two points have no sum
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Point<World> p_W, q_W;
  static_cast<void>(p_W + q_W);
}
