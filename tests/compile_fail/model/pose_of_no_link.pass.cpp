#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(Poses<ur5::Model, link_bit<5>>(ur5::Model{}, JointPosition<6>{}));
}
