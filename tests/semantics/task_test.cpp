#include "skinctl/semantics/task.hpp"

#include <doctest/doctest.h>

#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skills/behaviours.hpp"
#include "skinctl/skills/skill_set.hpp"
#include "tests/semantics/packing_task.hpp"

using namespace skinctl;
using namespace skinctl::testing;

// Wrong tasks do not compile: tests/compile_fail/semantics.

TEST_CASE("task: the fixed point proves what holds before each step") {
  static_assert(packing_oranges.holds[packing_step::look] == fact::none);
  static_assert(packing_oranges.holds[packing_step::take] == (fact::seen | fact::around));
  static_assert(packing_oranges.holds[packing_step::to_box] == (fact::in_hand | fact::good));
  static_assert(packing_oranges.holds[packing_step::to_bin] == (fact::in_hand | fact::bad));
  static_assert(packing_oranges.may_hold[packing_step::look] ==
                fact::placed);                        // around the loop, or the first time
  static_assert(packing_oranges.ends == fact::none);  // it may end before the first orange
  CHECK(packing_oranges.steps.size() == 9);
}

TEST_CASE("process: tasks one after the other are a task, proved again") {
  constexpr auto one =
      task("one", {}, step_of<activity::Look>({.done = 1}), step_of<activity::ReachAbove>({.done = 2}),
           step_of<activity::Reach>({.done = 3}), step_of<activity::Take>({.done = finish}));
  constexpr auto two = task("two", fact::in_hand, step_of<activity::Put>({.done = 1, .failed = ask_person}),
                            step_of<activity::Release>({.failed = ask_person}));
  static_assert(one.ends == fact::in_hand && two.ends == fact::placed);
  constexpr auto both = process("both", one, two);
  static_assert(both.steps.size() == 6 && both.ends == fact::placed);
  static_assert(both.steps[3].done == 4 && both.steps[4].done == 5 && both.steps[5].done == finish);
  static_assert(both.steps[4].failed == ask_person && both.steps[2].failed == 0);
  constexpr auto three = process("three", one, two, packing_oranges);
  static_assert(three.steps.size() == 15 && three.steps[14].done == 6);
  CHECK(three.ends == packing_oranges.ends);
}

namespace {
struct Robot {
  using Names = Behaviours<behaviour::Reaching, behaviour::Putting, behaviour::Squeezing>;
  template <class B>
  static constexpr std::uint8_t index() {
    static_assert(Names::index<B> < Names::count);
    return static_cast<std::uint8_t>(Names::index<B>);
  }
};
constexpr auto robot = boost::hana::make_map(
    done_by<activity::Look, behaviour::Putting>(), done_by<activity::ReachAbove, behaviour::Reaching>(),
    done_by<activity::Reach, behaviour::Reaching>(), done_by<activity::Take, behaviour::Squeezing>(),
    done_by<activity::Squeeze, behaviour::Squeezing>(), done_by<activity::Put, behaviour::Putting>(),
    done_by<activity::Release, behaviour::Reaching>(), done_by<activity::Reverse, behaviour::Putting>());
}  // namespace

TEST_CASE("skill_map: each activity has the index of its behaviour's skill") {
  constexpr auto skills = skill_map<Robot>(robot, packing_oranges);
  static_assert(skills(&activity::Reach::rule) == 0 && skills(&activity::Put::rule) == 1);
  static_assert(skills(&activity::Squeeze::rule) == 2 && skills(nullptr) == skills.none);
  CHECK(skills.rows.size() == 8);
}
