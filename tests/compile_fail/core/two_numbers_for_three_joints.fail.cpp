// expect: 0\.1, 0\.2.*one number per joint
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<3> q{0.1, 0.2};
  static_cast<void>(q);
}
