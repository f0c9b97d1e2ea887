// expect: M takes joint accelerations
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const MassMatrix<6> M;
  [[maybe_unused]] const JointVelocity<6> dq;
  [[maybe_unused]] const JointAcceleration<6> ddq;
#ifdef SKINCTL_RIGHT
  static_cast<void>(M * ddq);
#else
  static_cast<void>(M * dq);
#endif
}
