// expect: inner frames differ
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  // The finger's last link is link 3 of the finger, and link 9 of the arm that carries it.
  const auto robot = attach<5>(ur5::Model{}, allegro::right_fingers<1>());
  const auto X_BL = link_poses<link_bit<9>>(robot, JointPosition<10>{}).get<9>();
#ifdef SKINCTL_RIGHT
  static_cast<void>(X_BL * Transform<Link<9>, Cell>());
#else
  static_cast<void>(X_BL * Transform<Link<3>, Cell>());
#endif
}
