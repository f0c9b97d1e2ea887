// expect: 0\.1, 0\.2.*one number per joint
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  const JointPosition<3> q{0.1, 0.2, 0.3};
#else
  const JointPosition<3> q{0.1, 0.2};
#endif
  static_cast<void>(q);
}
