// expect: the torque of this law is not a JointTorque
// lines: 10
#include <Eigen/Core>

#include "tests/compile_fail/sound.hpp"

struct Brake : StatelessLaw<Brake> {
#ifdef SKINCTL_RIGHT
  JointTorque<6> torque(const auto& known) const noexcept {
    return JointTorque<6>(Eigen::Matrix<double, 6, 1>(-5.0 * as_eigen(known.dq())));
  }
#else
  Eigen::Matrix<double, 6, 1> torque(const auto& known) const noexcept { return -5.0 * as_eigen(known.dq()); }
#endif
};

auto build() {
  return Cycle(sound_arm(), Brake{} + GravityControl{});
}
