#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  using T = float;
  const ur5::Model model;
  const JointPosition<6, T> q;
  const JointVelocity<6, T> dq;
  const JointTorque<6, T> tau;
  static_cast<void>(forward_dynamics(model, q, dq, tau));
}
