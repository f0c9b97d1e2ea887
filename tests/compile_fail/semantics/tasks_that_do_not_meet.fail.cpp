// expect: a_step_lacks_a_fact_that_it_needs
#include "skinctl/semantics/process.hpp"

using namespace skinctl;

constexpr auto look = task("look", {}, step_of<activity::Look>({}));
#ifdef SKINCTL_RIGHT
constexpr auto put = task("put", fact::seen, step_of<activity::ReachAbove>({.failed = ask_person}));
#else
constexpr auto put = task("put", fact::in_hand, step_of<activity::Put>({.failed = ask_person}));
#endif
constexpr auto both = [] {
  Process<2> out;
  for (const auto& t : {look, put})
    if (TaughtTask<2> task; append(task, t)) task.begins = t.begins, out.tasks[out.size++] = task;
  return out;
}();
const auto one = joined(both);
