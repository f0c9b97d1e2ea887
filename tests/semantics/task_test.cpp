// Promise: a task whose step lacks a fact, cannot be reached, has no end, or begins with what it forbids
// does not compile
// Tried: over done, no and failed; processes of three tasks in six wrong forms, and one that is executed; a
// robot without a behaviour for an activity. Also: `compile_fail/semantics/`

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "skinctl/semantics/executor.hpp"
#include "skinctl/semantics/process.hpp"
#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skills/behaviours.hpp"
#include "skinctl/skills/skill_set.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/semantics/packing_task.hpp"

using namespace skinctl;
using namespace skinctl::testing;

// Wrong tasks do not compile: tests/compile_fail/semantics.

namespace {
using Plan = TaughtTask<decltype(packing_oranges)::capacity>;
static_assert(std::is_trivially_copyable_v<Plan> && std::is_trivially_copyable_v<TaskFault>);

/// Walks a task as somebody does who knows nothing of proofs: a set of the numbers of facts, and dice. True:
/// something was missing, in the way, or led nowhere.
bool walk_breaks(const Plan& t, Random& random) {
  std::set<int> known;
  std::size_t at = 0;
  for (int i = 0; i < 60; ++i) {
    const Step& s = t.steps[at];
    for (int bit = 0; bit < 32; ++bit) {
      const bool needed = (((s.does->needs.bits | s.needs.bits) >> bit) & 1u) != 0;
      if (needed && known.count(bit) == 0) return true;
      if (((s.does->forbids.bits >> bit) & 1u) != 0 && known.count(bit) != 0) return true;
    }
    const auto dice = random() % 8;
    if (dice == 0 && s.failed < t.size) {
      known.clear();  // a person who has come cannot say what is left
      at = s.failed;
      continue;
    }
    const bool no = dice < 4 && s.no != nowhere;
    for (int bit = 0; bit < 32; ++bit) {
      if (((s.does->removes.bits >> bit) & 1u) != 0) known.erase(bit);
      if ((((no ? s.does->adds_if_no : s.does->adds).bits >> bit) & 1u) != 0) known.insert(bit);
    }
    const std::uint8_t to = no ? s.no : s.done;
    if (to == finish || to == ask_person) return false;
    if (to >= t.size) return true;
    at = to;
  }
  return false;
}
Plan changed(Plan t, Random& random) {
  for (std::uint64_t k = 1 + random() % 3; k > 0; --k) {
    Step& s = t.steps[random() % t.size];
    const auto to = static_cast<std::uint8_t>(random() % 10 == 0 ? finish : random() % (t.size + 1u));
    const auto which = random() % 5;
    if (which == 0) s.done = to;
    if (which == 1) s.no = to;
    if (which == 2) s.failed = to;
    if (which == 3) s.does = t.steps[random() % t.size].does;
    if (which == 4) std::swap(s, t.steps[random() % t.size]);
  }
  return t;
}
}  // namespace

TEST_CASE("check: of 20 000 changes of a plan, each that a walk breaks is refused, and some are accepted") {
  auto random = seeded(31);
  int broken = 0, accepted = 0, missed = 0;
  for (int i = 0; i < (sanitized ? 2000 : 20000); ++i) {
    Plan t = changed(packing_oranges, random);
    const bool refused = check(t).any();
    bool breaks = false;
    for (int walk = 0; walk < 30 && !breaks; ++walk) breaks = walk_breaks(t, random);
    broken += breaks ? 1 : 0;
    accepted += refused ? 0 : 1;
    missed += breaks && !refused ? 1 : 0;
  }
  MESSAGE("broken by a walk " << broken << ", of these accepted " << missed << "; accepted in all "
                              << accepted);
  CHECK(missed == 0);
  CHECK(broken > (sanitized ? 1000 : 10000));
  CHECK(accepted > (sanitized ? 50 : 500));
}

TEST_CASE("check: says what is wrong, where, and which facts are missing") {
  const auto fault = [](auto change) {
    Plan t = packing_oranges;
    change(t);
    return check(t);
  };
  const auto lacks = fault([](Plan& t) { t.steps[packing_step::look].done = packing_step::reach; });
  CHECK(lacks.error == TaskError::a_step_cannot_be_reached);
  CHECK(lacks.step == packing_step::above);
  const auto bad = fault([](Plan& t) { t.steps[packing_step::squeeze].no = packing_step::to_box; });
  CHECK(bad.error == TaskError::a_step_lacks_a_fact_that_it_needs);
  CHECK((bad.step == packing_step::to_box && bad.facts == fact::good));
  CHECK(fault([](Plan& t) { t.size = 0; }).error == TaskError::a_task_has_no_step_or_too_many);
  CHECK(fault([](Plan& t) { t.size = 200; }).error == TaskError::a_task_has_no_step_or_too_many);
  CHECK(fault([](Plan& t) { t.steps[2].border = 0; }).error ==
        TaskError::a_step_has_a_place_or_border_that_does_not_exist);
  CHECK(fault([](Plan& t) { t.place_count = 1; }).error ==
        TaskError::a_step_has_a_place_or_border_that_does_not_exist);
  CHECK(fault([](Plan& t) { t.border_count = 1; }).error == TaskError::a_place_or_border_is_not_finite);
  CHECK(fault([](Plan& t) { t.border_count = 9; }).error ==
        TaskError::a_step_has_a_place_or_border_that_does_not_exist);
  CHECK(fault([](Plan& t) { t.steps[4].does = nullptr; }).error == TaskError::a_step_has_no_activity);
}

TEST_CASE("append: numbers of places and borders move along") {
  Plan taught = packing_oranges;
  taught.place_count = 2, taught.border_count = 1, taught.borders[0] = 5;
  taught.steps[packing_step::squeeze].border = 0;
  TaughtTask<20> both{};
  CHECK((append(both, taught) && append(both, taught)));
  CHECK_FALSE(append(both, taught));
  CHECK_FALSE(check(both).any());
  CHECK(both.steps[9 + packing_step::to_bin].place == 3);
  CHECK(both.steps[9 + packing_step::squeeze].border == 1);
  CHECK(both.borders[1] == 5);
}

TEST_CASE("task: a task behind itself is the task twice, and proved; without room nothing changes") {
  TaughtTask<2 * packing_oranges.capacity> twice{};
  REQUIRE(append(twice, packing_oranges));
  REQUIRE(append(twice, twice));
  CHECK(twice.size == 2 * packing_oranges.size);
  const std::size_t by = packing_oranges.size;
  for (std::size_t i = 0; i < by; ++i) {
    const Step &first = twice.steps[i], &second = twice.steps[by + i], &was = packing_oranges.steps[i];
    const auto leads = [&](std::uint8_t to, std::size_t from, std::uint8_t end) {
      return to == finish ? end : to < nowhere ? static_cast<std::uint8_t>(to + from) : to;
    };
    CHECK(first.done == leads(was.done, 0, static_cast<std::uint8_t>(by)));
    CHECK(second.done == leads(was.done, by, finish));
    CHECK(second.failed == leads(was.failed, by, finish));
    CHECK(second.no == leads(was.no, by, finish));
  }
  CHECK_FALSE(append(twice, packing_oranges));
  CHECK(twice.size == 2 * packing_oranges.size);
}

TEST_CASE("task: the fixed point proves what holds before each step") {
  constexpr auto facts = facts_of(packing_oranges);
  static_assert(facts.holds[packing_step::look] == fact::none);
  static_assert(facts.holds[packing_step::take] == (fact::seen | fact::around));
  static_assert(facts.holds[packing_step::to_box] == (fact::in_hand | fact::good));
  static_assert(facts.holds[packing_step::to_bin] == (fact::in_hand | fact::bad));
  static_assert(facts.may_hold[packing_step::look] == fact::placed);  // around the loop, or the first time
  static_assert(packing_oranges.ends == fact::none);                  // it may end before the first orange
  CHECK(packing_oranges.steps.size() == 9);
}

namespace {
using Tasks = Process<20>;
constexpr TaughtTask<20> task_of(const char* name, Facts begins, std::initializer_list<Step> steps) {
  TaughtTask<20> out{};
  out.name = name;
  out.begins = begins;
  for (const Step& s : steps) out.steps[out.size++] = s;
  return out;
}
/// A bad orange is put away, a good one stays in the hand; it is over when there is none.
constexpr auto sort =
    task_of("sort", {},
            {step_of<activity::Look>({.done = 1, .no = finish}), step_of<activity::ReachAbove>({.done = 2}),
             step_of<activity::Reach>({.done = 3}), step_of<activity::Take>({.done = 4}),
             step_of<activity::Squeeze>({.done = finish, .no = 5}),
             step_of<activity::Put>({.place = bin, .done = 6, .needs = fact::bad}),
             step_of<activity::Release>({.place = bin, .done = 0})});
constexpr auto pack = task_of("pack", fact::in_hand | fact::good,
                              {step_of<activity::Put>({.place = box, .done = 1, .failed = finish}),
                               step_of<activity::Release>({.place = box, .failed = finish})});
/// What looks as if it were full is taken by a wall.
constexpr auto away =
    task_of("away", {},
            {step_of<activity::Look>({.role = 4, .done = 1, .no = finish}),
             step_of<activity::ReachAbove>({.done = 2}), step_of<activity::Reach>({.done = 3}),
             step_of<activity::Take>({.done = 4}), step_of<activity::Carry>({.done = 5}),
             step_of<activity::Put>({.done = 6}), step_of<activity::Release>({.done = finish})});
constexpr Tasks process_of(bool repeats, std::initializer_list<TaughtTask<20>> tasks) {
  Tasks out{.name = "process", .repeats = repeats};
  for (const auto& t : tasks) out.tasks[out.size++] = t;
  return out;
}
}  // namespace

TEST_CASE("join: tasks one after the other are a task; what they leave each other is proved") {
  constexpr auto once = joined(process_of(false, {away, sort}));
  static_assert(once.size == 14 && once.steps[0].no == 7 && once.steps[6].done == 7);
  static_assert(once.steps[7].no == finish && once.steps[11].done == finish);
  constexpr auto whole = joined(process_of(true, {sort, pack, away}));
  static_assert(whole.size == 16 && whole.steps[4].done == 7 && whole.steps[8].done == 9);
  static_assert(whole.steps[0].no == finish);                          // no orange: it is over
  static_assert(whole.steps[9].no == 0 && whole.steps[15].done == 0);  // not full, or put away: it goes on
  static_assert(whole.steps[7].failed == 9 && whole.steps[9].failed == 9);  // it went back: the next task
  CHECK(facts_of(whole).holds[7] == (fact::in_hand | fact::good));
  CHECK(facts_of(whole).holds[9] == fact::none);
  CHECK(std::is_trivially_copyable_v<Tasks>);
}

TEST_CASE("join: a process with a fault is refused; task, step and facts are named") {
  const auto fault = [](bool repeats, std::initializer_list<TaughtTask<20>> tasks) {
    TaughtTask<20> whole{};
    return join(process_of(repeats, tasks), whole);
  };
  CHECK_FALSE(fault(true, {sort, pack, away}).any());
  const auto is = [](const ProcessFault& f, std::uint8_t task, TaskError error, std::uint8_t step,
                     Facts facts) {
    CAPTURE(int(f.task));
    CAPTURE(int(f.fault.step));
    CAPTURE(describe(f.fault.error));
    CHECK(f.task == task);
    CHECK(f.fault.error == error);
    CHECK(f.fault.step == step);
    CHECK(f.fault.facts == facts);
  };
  using enum TaskError;
  is(fault(true, {sort, away, pack}), 2, a_step_lacks_a_fact_that_it_needs, 0, fact::in_hand | fact::good);
  is(fault(true, {pack, sort, away}), 0, a_step_lacks_a_fact_that_it_needs, 0, fact::in_hand | fact::good);
  // Two that look: the second one would take with an orange in the hand.
  is(fault(false, {sort, sort}), 1, a_step_may_begin_with_a_fact_that_it_forbids, 1, fact::in_hand);
  TaughtTask<20> stays = pack;
  stays.steps[0].failed = 0;
  is(fault(true, {sort, stays}), 1, a_step_lacks_a_fact_that_it_needs, 0, fact::in_hand);
  TaughtTask<20> unreached = away;
  unreached.steps[2].done = 4;
  is(fault(true, {sort, pack, unreached}), 2, a_step_cannot_be_reached, 3, {});
  is(fault(false, {sort, pack, away, sort}), 3, a_task_has_no_step_or_too_many, sort.size, {});
  is(fault(false, {}), 0, a_task_has_no_step_or_too_many, 0, {});
  // Not repeated, the first one may leave what it began with; repeated, it begins again with what the last one leaves.
  CHECK_FALSE(fault(false, {pack, sort}).any());
}

TEST_CASE("Executor: a process goes from task to task, and back to the first, until that has nothing to do") {
  constexpr auto whole = joined(process_of(true, {sort, pack, away}));
  const Executor<20> executor(whole);
  auto memory = executor.start(1s);
  Nanoseconds now = 1s;
  std::vector<int> steps;
  int oranges = 0, in_box = 0;
  for (int i = 0; i < 10'000 && memory.phase != Executor<20>::Phase::finished; ++i, now += 8ms) {
    SkillReport skill{memory.ticket, SkillPhase::finished, {}};
    const bool answer = memory.step == 0   ? oranges < 5
                        : memory.step == 4 ? oranges != 2  // the second one is bad
                        : memory.step == 9 ? in_box == 2   // two fill the box
                                           : true;
    const auto was = memory.step;
    memory = executor.step(memory, {.now = now, .skill = skill, .answer = answer}).memory;
    if (memory.step == was && memory.phase != Executor<20>::Phase::finished) continue;
    steps.push_back(was);
    oranges += was == 3, in_box += was == 8;
    if (was == 15) in_box = 0;
  }
  CHECK((memory.phase == Executor<20>::Phase::finished));
  CHECK(oranges == 5);
  const auto times = [&](int step) { return std::count(steps.begin(), steps.end(), step); };
  CHECK(times(8) == 4);   // four good ones are packed,
  CHECK(times(6) == 1);   // a bad one is not,
  CHECK(times(15) == 2);  // two boxes are put away,
  CHECK(times(9) == 4);   // and it was asked after each orange that was packed
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
