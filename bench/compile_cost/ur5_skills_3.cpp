// budget: 12 s 900 MB
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/skills/library.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

using namespace skinctl;
