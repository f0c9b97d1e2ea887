#include "skinctl/semantics/task.hpp"

using namespace skinctl;

const auto right = task("look", {}, step_of<activity::Look>({.done = 1}), step_of<activity::Look>({}));
