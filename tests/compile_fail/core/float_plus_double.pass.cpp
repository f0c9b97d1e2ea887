#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointPosition<6, float> q_float;
  static_cast<void>(q + q_float.cast<double>());
}
