// expect: a frame has no pose in itself
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<World, Cell> X_WC;
#ifdef SKINCTL_RIGHT
  static_cast<void>(X_WC.renamed<World, Tool>());
#else
  static_cast<void>(X_WC.renamed<World, World>());
#endif
}
