// expect: takes a wrench on the Jacobian's body
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const ur5::Model model;
  const auto J = jacobian<5>(link_poses(model, q));
  const auto A = operational_mobility(J, MassFactors<ur5::Model>(mass_matrix(model, q)));
  [[maybe_unused]] const Twist<Link<5>, Base> V;
  [[maybe_unused]] const Wrench<Link<5>, Link<5>, Base> F;
#ifdef SKINCTL_RIGHT
  static_cast<void>(A * F);
#else
  static_cast<void>(A * V);
#endif
}
