// expect: gravity twice: keep one gravity law
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
#ifdef SKINCTL_RIGHT
  static_cast<void>(gravity + skin);
#else
  static_cast<void>(gravity + skin + gravity);
#endif
}
