// A user's program, built against skinctl in every way that users have.
#include <Eigen/Core>
#include <cmath>
#include <cstdio>

#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::ur5::Model robot;
  const skinctl::JointPosition<6> stretched;  // all zero: along -x
  const auto tau = skinctl::gravity_torque(robot, stretched);
  const auto p = skinctl::link_poses(robot, stretched).get<5>().translation();
  std::printf("shoulder holds %.3f N m, wrist at x = %.4f m\n", tau[1], p.x());
  return std::abs(p.x() - (-0.425 - 0.39225)) < 1e-12 && std::abs(tau[1]) > 30 ? 0 : 1;
}
