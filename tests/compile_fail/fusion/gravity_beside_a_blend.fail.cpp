// expect: a blend of the whole sum
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
  const skinctl::SplineJoint<6> reach{};
#ifdef SKINCTL_RIGHT
  static_cast<void>(blended(skin + reach + gravity));
#else
  static_cast<void>(blended(skin + reach + gravity) + gravity);
#endif
}
