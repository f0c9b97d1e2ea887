// expect: a_step_cannot_be_reached
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
const auto right = task("look", {}, step_of<activity::Look>({.done = 1}), step_of<activity::Look>({}));
#else
const auto wrong = task("look", {}, step_of<activity::Look>({}), step_of<activity::Look>({}));
#endif
