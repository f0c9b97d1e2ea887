#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const MassMatrix<6> M;
  [[maybe_unused]] const JointVelocity<6> dq;
  [[maybe_unused]] const JointAcceleration<6> ddq;
  static_cast<void>(M * ddq);
}
