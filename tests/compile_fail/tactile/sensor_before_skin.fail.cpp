// expect: skins stand first
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  return wrist_sensor<5>(ur5::Model{}) + ur5_skin<260>();
}
