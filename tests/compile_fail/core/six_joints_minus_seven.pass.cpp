#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointPosition<7> q_7;
  static_cast<void>(q_7 - q_7);
}
