// expect: a frame has no pose in itself.*rotated_z
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(Transform<World, Cell>::translation_xyz(1, 0, 0) *
                    Transform<Cell, Cell>::rotation_x(0.5));
}
