// expect: state.q = q.*q = JointPosition<N>
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  State<6> state;
  const std::array<double, 6> q{};
#ifdef SKINCTL_RIGHT
  state.q = JointPosition<6>(q);
#else
  state.q = q;
#endif
}
