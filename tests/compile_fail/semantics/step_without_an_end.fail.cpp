// expect: a_step_has_no_way_to_the_end
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
const auto right = task("look", {}, step_of<activity::Look>({.done = 1}),
                        step_of<activity::Look>({.done = 0, .no = finish}));
#else
const auto wrong =
    task("look", {}, step_of<activity::Look>({.done = 1}), step_of<activity::Look>({.done = 0}));
#endif
