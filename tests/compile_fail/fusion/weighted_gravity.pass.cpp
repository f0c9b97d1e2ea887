#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"

int main() {
  const skinctl::SkinJointControl skin;
  static_cast<void>(0.5 * skin);
}
