// expect: a time has a unit: 4ms
// lines: 10
#include "skinctl/skinctl.hpp"

using namespace skinctl;

void change(RobotConfiguration<6>& configuration) {
#ifdef SKINCTL_RIGHT
  configuration.delay = nanoseconds(0.004);
#else
  configuration.delay = 0.004;
#endif
}
