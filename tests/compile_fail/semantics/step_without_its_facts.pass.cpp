#include "skinctl/semantics/task.hpp"

using namespace skinctl;

const auto right =
    task("take", {}, step_of<activity::Look>({.done = 1}), step_of<activity::ReachAbove>({.done = 2}),
         step_of<activity::Reach>({.done = 3}), step_of<activity::Take>({}));
