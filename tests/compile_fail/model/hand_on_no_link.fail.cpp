// expect: the trunk has no such link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(attach<6>(ur5::Model{}, allegro::right_hand()));
}
