// expect: no goal of this scene.s law: JointGoal
// lines: 10
#include <Eigen/Core>

#include "tests/compile_fail/sound.hpp"

auto build() {
  const auto cycle = Cycle(sound_arm(), SplineJoint(sound_arm()) + GravityControl{});
  decltype(cycle)::Input input;
  const Vec6<double> q = Vec6<double>::Zero();
#ifdef SKINCTL_RIGHT
  input.goal = JointGoal<6>{JointPosition<6>(q), 2s};
#else
  input.goal = q;
#endif
  return input;
}
