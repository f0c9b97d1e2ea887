#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(
      inverse_dynamics(ur5::Model{}, JointPosition<6>{}, JointVelocity<6>{}, JointAcceleration<6>{}));
}
