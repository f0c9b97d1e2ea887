// expect: OnMovingBase goes outside
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
using Carried = OnMovingBase<Loaded<ur5::Model, 5>>;
#else
using Carried = Loaded<OnMovingBase<ur5::Model>, 5>;
#endif
static_assert(base_moves<Carried>);
