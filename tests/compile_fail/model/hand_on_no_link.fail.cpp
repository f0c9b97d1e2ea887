// expect: the trunk has no such link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(attach<5>(ur5::Model{}, allegro::right_hand()));
#else
  static_cast<void>(attach<6>(ur5::Model{}, allegro::right_hand()));
#endif
}
