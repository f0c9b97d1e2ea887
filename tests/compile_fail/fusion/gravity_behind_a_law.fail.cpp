// expect: gravity is held whole, not in a null space
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
  const skinctl::SplineJoint<6> reach{};
#ifdef SKINCTL_RIGHT
  static_cast<void>(skinctl::task_priority<5>(reach, reach) + skin + gravity);
#else
  static_cast<void>(skinctl::task_priority<5>(reach, gravity) + skin);
#endif
}
