// expect: \(q - q_7\).*other kind, size or scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointPosition<7> q_7;
#ifdef SKINCTL_RIGHT
  static_cast<void>(q_7 - q_7);
#else
  static_cast<void>(q - q_7);
#endif
}
