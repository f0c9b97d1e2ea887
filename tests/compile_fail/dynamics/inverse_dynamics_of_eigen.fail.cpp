// expect: inverse_dynamics.*JointPosition<N>\(v\)
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
  const State<6> x;
  const Vec6<double> v = Vec6<double>::Zero();
#ifdef SKINCTL_RIGHT
  static_cast<void>(inverse_dynamics(model, x.q, x.dq, JointAcceleration<6>(v)));
#else
  static_cast<void>(inverse_dynamics(model, x.q, x.dq, v));
#endif
}
