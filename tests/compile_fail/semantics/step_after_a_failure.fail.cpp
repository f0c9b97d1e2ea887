// expect: a_step_lacks_a_fact_that_it_needs
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
const auto right = task("put", fact::in_hand, step_of<activity::Put>({.done = 1, .failed = ask_person}),
                        step_of<activity::Release>({.failed = ask_person}));
#else
// After a failure nothing is certain: it cannot go on with what needs an object in hand.
const auto wrong = task("put", fact::in_hand, step_of<activity::Put>({.done = 1, .failed = 1}),
                        step_of<activity::Release>({.failed = ask_person}));
#endif
