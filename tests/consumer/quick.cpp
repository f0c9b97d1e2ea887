// A user's program as it is compiled while it is edited.
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/robots/ur5.hpp"

#if !defined(SKINCTL_NO_FORCED_INLINE) || !defined(__OPTIMIZE__)
#error "skinctl::quick optimises, and leaves inlining to the compiler"
#endif

int main() {
  const auto tau = skinctl::gravity_torque(skinctl::ur5::Model{}, skinctl::JointPosition<6>{});
  return tau[1] < -30 || tau[1] > 30 ? 0 : 1;
}
