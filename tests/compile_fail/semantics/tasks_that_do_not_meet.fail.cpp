// expect: a_task_begins_without_the_facts_that_it_needs
#include "skinctl/semantics/task.hpp"

using namespace skinctl;

constexpr auto look = task("look", {}, step_of<activity::Look>({}));
#ifdef SKINCTL_RIGHT
constexpr auto put = task("put", fact::seen, step_of<activity::ReachAbove>({.failed = ask_person}));
const auto right = process("reach what is seen", look, put);
#else
constexpr auto put = task("put", fact::in_hand, step_of<activity::Put>({.failed = ask_person}));
const auto wrong = process("put what is seen", look, put);
#endif
