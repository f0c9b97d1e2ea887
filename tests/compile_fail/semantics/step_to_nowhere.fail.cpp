// expect: a_step_leads_to_a_step_that_does_not_exist
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
const auto right = task("look", {}, step_of<activity::Look>({.done = finish}));
#else
const auto wrong = task("look", {}, step_of<activity::Look>({.done = 7}));
#endif
