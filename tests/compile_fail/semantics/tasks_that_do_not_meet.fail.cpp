// expect: a_step_lacks_a_fact_that_it_needs
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

constexpr auto look = task("look", {}, step_of<activity::Look>({}));
#ifdef SKINCTL_RIGHT
constexpr auto put = task("put", fact::seen, step_of<activity::ReachAbove>({.failed = ask_person}));
const auto right = process("reach what is seen", look, put);
#else
constexpr auto put = task("put", fact::in_hand, step_of<activity::Put>({.failed = ask_person}));
const auto wrong = process("put what is seen", look, put);
#endif
