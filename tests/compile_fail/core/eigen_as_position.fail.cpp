// expect: state.q = v.*q = JointPosition<N>
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  State<6> state;
  const Vec6<double> v = Vec6<double>::Zero();
#ifdef SKINCTL_RIGHT
  state.q = JointPosition<6>(v);
  as_eigen(state.q) = v;
#else
  state.q = v;
#endif
}
