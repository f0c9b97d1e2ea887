// expect: gravity keeps weight 1
#include "skinctl/skinctl.hpp"

int main() {
#ifdef SKINCTL_RIGHT
  const skinctl::SkinJointControl skin;
  static_cast<void>(0.5 * skin);
#else
  const skinctl::GravityControl gravity;
  static_cast<void>(0.5 * gravity);
#endif
}
