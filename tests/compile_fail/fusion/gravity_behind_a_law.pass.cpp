#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
  const skinctl::SplineJoint<6> reach{};
  static_cast<void>(skinctl::task_priority<5>(reach, reach) + skin + gravity);
}
