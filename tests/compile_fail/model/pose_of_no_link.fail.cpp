// expect: the mask names a link that the model does not have
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(Poses<ur5::Model, link_bit<5>>(ur5::Model{}, JointPosition<6>{}));
#else
  static_cast<void>(Poses<ur5::Model, link_bit<6>>(ur5::Model{}, JointPosition<6>{}));
#endif
}
