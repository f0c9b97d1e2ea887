// expect: \(q \+ q_float\).*other kind, size or scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointPosition<6, float> q_float;
#ifdef SKINCTL_RIGHT
  static_cast<void>(q + q_float.cast<double>());
#else
  static_cast<void>(q + q_float);
#endif
}
