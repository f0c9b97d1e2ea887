#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<Base, World> X_BW;
  const Obstacle<World> o_W;
  static_cast<void>(X_BW * o_W);
}
