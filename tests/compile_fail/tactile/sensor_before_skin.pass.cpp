#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  return ur5_skin<260>() + wrist_sensor<5>(ur5::Model{});
}
