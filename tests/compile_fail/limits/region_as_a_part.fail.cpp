// expect: a governor takes JerkLimits, ToolSpeed, ClearanceLimits, ContactLimits, MotionLimits and CoverageLimits
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto wrong(const JointLimits<6>& limits, const BodyRegion& region) {
  return make_governor(limits, region);
}
