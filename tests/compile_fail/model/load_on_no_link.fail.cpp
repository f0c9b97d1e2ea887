// expect: the model has no such link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(Loaded<ur5::Model, 5>(ur5::Model{}));
#else
  static_cast<void>(Loaded<ur5::Model, 6>(ur5::Model{}));
#endif
}
