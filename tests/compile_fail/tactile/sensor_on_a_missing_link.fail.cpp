// expect: a wrist sensor on a link that the model does not have
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  return wrist_sensor<5>(ur5::Model{});
#else
  return wrist_sensor<6>(ur5::Model{});
#endif
}
