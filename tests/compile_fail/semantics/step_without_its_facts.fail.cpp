// expect: a_step_lacks_a_fact_that_it_needs
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
const auto right =
    task("take", {}, step_of<activity::Look>({.done = 1}), step_of<activity::ReachAbove>({.done = 2}),
         step_of<activity::Reach>({.done = 3}), step_of<activity::Take>({}));
#else
const auto wrong = task("take", {}, step_of<activity::Look>({.done = 1}),
                        step_of<activity::ReachAbove>({.done = 2}), step_of<activity::Take>({}));
#endif
