// expect: gravity is always held
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
  const skinctl::SplineJoint<6> reach{};
#ifdef SKINCTL_RIGHT
  static_cast<void>(when_touched(reach) + skin + gravity);
#else
  static_cast<void>(when_touched(gravity) + skin + reach);
#endif
}
