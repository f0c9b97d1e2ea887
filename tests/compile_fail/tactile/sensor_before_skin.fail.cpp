// expect: skins stand first
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  return ur5_skin<260>() + wrist_sensor<5>(ur5::Model{});
#else
  return wrist_sensor<5>(ur5::Model{}) + ur5_skin<260>();
#endif
}
