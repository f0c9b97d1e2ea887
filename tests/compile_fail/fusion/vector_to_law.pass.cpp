#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"

int main() {
  const skinctl::SkinJointControl skin;
  const skinctl::GravityControl gravity;
  static_cast<void>(skin + gravity);
}
