#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(attach<5>(ur5::Model{}, allegro::right_hand()));
}
