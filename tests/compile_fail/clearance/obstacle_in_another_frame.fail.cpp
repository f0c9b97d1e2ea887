// expect: \(X_BW \* o_B\).*the obstacle is in another frame
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<Base, World> X_BW;
  const Obstacle<Base> o_B;
  static_cast<void>(X_BW * o_B);
}
