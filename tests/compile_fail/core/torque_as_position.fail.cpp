// expect: q = tau.*other kind, size or scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const JointPosition<6> q = tau;
  static_cast<void>(q);
}
