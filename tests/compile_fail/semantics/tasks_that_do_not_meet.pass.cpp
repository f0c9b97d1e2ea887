#include "skinctl/semantics/task.hpp"

using namespace skinctl;

constexpr auto look = task("look", {}, step_of<activity::Look>({}));
constexpr auto put = task("put", fact::seen, step_of<activity::ReachAbove>({.failed = ask_person}));
const auto right = process("reach what is seen", look, put);
