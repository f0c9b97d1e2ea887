#include "skinctl/semantics/task.hpp"

using namespace skinctl;

const auto right = task("put", fact::in_hand, step_of<activity::Put>({.done = 1, .failed = ask_person}),
                        step_of<activity::Release>({.failed = ask_person}));
