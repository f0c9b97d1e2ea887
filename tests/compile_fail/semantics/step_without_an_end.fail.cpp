// expect: a_step_has_no_way_to_the_end
#include "skinctl/semantics/task.hpp"

using namespace skinctl;

const auto wrong =
    task("look", {}, step_of<activity::Look>({.done = 1}), step_of<activity::Look>({.done = 0}));
