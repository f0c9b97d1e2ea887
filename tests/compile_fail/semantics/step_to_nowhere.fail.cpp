// expect: a_step_leads_to_a_step_that_does_not_exist
#include "skinctl/semantics/task.hpp"

using namespace skinctl;

const auto wrong = task("look", {}, step_of<activity::Look>({.done = 7}));
