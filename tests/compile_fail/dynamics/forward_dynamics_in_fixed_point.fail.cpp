// expect: forward_dynamics\(model, q, dq, tau\)|pivots lose their digits in fixed point: forward dynamics need float
#include "bench/studies/fixed_point/fixed.hpp"
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  using T = float;
#else
  using T = math::Q9_22;
#endif
  const ur5::Model model;
  const JointPosition<6, T> q;
  const JointVelocity<6, T> dq;
  const JointTorque<6, T> tau;
  static_cast<void>(forward_dynamics(model, q, dq, tau));
}
