#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(Transform<World, Cell>::translation_xyz(1, 0, 0).rotated_x(0.5));
}
