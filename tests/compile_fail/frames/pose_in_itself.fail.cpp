// expect: a frame has no pose in itself.*rotated_z
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(Transform<World, Cell>::translation_xyz(1, 0, 0).rotated_x(0.5));
#else
  static_cast<void>(Transform<World, Cell>::translation_xyz(1, 0, 0) *
                    Transform<Cell, Cell>::rotation_x(0.5));
#endif
}
