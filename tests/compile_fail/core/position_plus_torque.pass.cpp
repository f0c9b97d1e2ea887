#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointTorque<6> tau;
  static_cast<void>(tau + tau);
}
