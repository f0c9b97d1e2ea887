#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto right(const JointLimits<6>& limits, const BodyRegion& region) {
  return make_governor(limits, contact_limits(ur5::Model{}, LinkContact<2>{.region = region}));
}
