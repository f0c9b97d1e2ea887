// expect: a law of the skin twice: keep one
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto law() {
#ifdef SKINCTL_RIGHT
  return SkinJointControl{} + GravityControl{};
#else
  return SkinJointControl{} + SkinJointControl{};
#endif
}
