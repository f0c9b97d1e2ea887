// expect: gravity twice: keep one gravity law
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
  const skinctl::SplineJoint<6> reach{};
#ifdef SKINCTL_RIGHT
  static_cast<void>(blended(when_touched(reach) + skin + gravity));
#else
  static_cast<void>(blended(gravity + when_touched(reach) + skin + gravity));
#endif
}
