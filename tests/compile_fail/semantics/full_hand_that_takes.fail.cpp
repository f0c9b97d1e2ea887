// expect: a_step_may_begin_with_a_fact_that_it_forbids
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
const auto right =
    task("take one", {}, step_of<activity::Look>({.done = 1}), step_of<activity::ReachAbove>({.done = 2}),
         step_of<activity::Reach>({.done = 3}), step_of<activity::Take>({.done = finish}));
#else
const auto wrong =
    task("take two", {}, step_of<activity::Look>({.done = 1}), step_of<activity::ReachAbove>({.done = 2}),
         step_of<activity::Reach>({.done = 3}), step_of<activity::Take>({.done = 0, .no = finish}));
#endif
