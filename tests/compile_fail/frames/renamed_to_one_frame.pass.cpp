#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<World, Cell> X_WC;
  static_cast<void>(X_WC.renamed<World, Tool>());
}
