// expect: 0\.1, 0\.2.*one number per joint
#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const JointPosition<3> q{0.1, 0.2};
  static_cast<void>(q);
}
