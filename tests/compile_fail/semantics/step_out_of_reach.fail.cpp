// expect: a_step_cannot_be_reached
#include "skinctl/semantics/task.hpp"

using namespace skinctl;

const auto wrong = task("look", {}, step_of<activity::Look>({}), step_of<activity::Look>({}));
