// Promise: an executor requests nothing whose needs are not proved; every failure ends in a retry, a way
// back or a person
// Tried: 200 000 random cycles, any bits in its memory; lost from the hand: 50 ms; skills that fail,
// never begin, never end; places that are not granted

#include "skinctl/semantics/executor.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "skinctl/core/real_time.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/semantics/packing_task.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Packing = Executor<packing_oranges.capacity>;
using Kind = StepRequest::Kind;
constexpr auto cycle = 4ms;

/// A robot that does what it is asked after 100 ms, in a world that a test disturbs.
class Robot {
 public:
  explicit Robot(const Packing& executor) : executor_(executor), m_(executor.start(0ns)) {}
  /// One cycle; the name of an activity that begins is added to the story.
  StepRequest step() {
    now_ += cycle;
    StepInput in{now_, {fact::in_hand, in_hand ? fact::in_hand : fact::none}, skill, answer, granted, resume};
    if (packing_oranges.steps[m_.step].no == nowhere) in.answer = true;  // only who decides says no
    const auto before = m_;
    const auto out = executor_.step(m_, in);
    CHECK(executor_.step(before, in).memory == out.memory);  // pure
    m_ = out.memory;
    const auto& r = out.request;
    if (r.kind == Kind::start && r.ticket != skill.ticket) {
      story.push_back(r.does->name);
      CHECK((r.does == &activity::Reverse::rule ||
             m_.facts.has(r.does->needs | packing_oranges.steps[r.step].needs)));
      skill = {r.ticket, deaf ? SkillPhase::loading : SkillPhase::running, SkillFailure::none};
      since_ = now_;
    }
    if (skill.phase == SkillPhase::running && r.kind == Kind::go_on && now_ - since_ >= 100ms) {
      const bool fails = r.does->name == failing && failures > 0;
      failures -= fails ? 1 : 0;
      skill.phase = fails ? SkillPhase::failed : SkillPhase::finished;
      if (!fails && r.does == &activity::Take::rule) in_hand = takes;
      if (r.does == &activity::Release::rule || r.does == &activity::Reverse::rule) in_hand = false;
    }
    return r;
  }
  /// Until the request is of this kind, or 60 s have passed.
  StepRequest until(Kind kind) {
    for (int i = 0; i < 15000; ++i)
      if (const auto r = step(); r.kind == kind) return r;
    FAIL("nothing happens");
    return {};
  }
  StepRequest until_begins(const std::string& name) {
    for (int i = 0; i < 15000; ++i) {
      const auto n = story.size();
      if (const auto r = step(); story.size() > n && story.back() == name) return r;
    }
    FAIL("nothing happens");
    return {};
  }
  [[nodiscard]] const Packing::Memory& memory() const { return m_; }
  [[nodiscard]] Nanoseconds now() const { return now_; }

  bool in_hand = false, takes = true, answer = true, granted = true, resume = false, deaf = false;
  SkillReport skill{};
  std::string failing;
  int failures = 0;
  std::vector<std::string> story;

 private:
  const Packing& executor_;
  Packing::Memory m_;
  Nanoseconds now_{}, since_{};
};
using Story = std::vector<std::string>;
const Packing executor(packing_oranges);
static_assert(sizeof(Packing::Memory) == 24);
}  // namespace

TEST_CASE(
    "Executor: a good orange goes into the box, a bad one into the bin, and no more oranges is the end") {
  Robot robot(executor);
  robot.until_begins("release");
  CHECK(robot.story == Story{"look", "reach_above", "reach", "take", "squeeze", "put", "release"});
  CHECK(executor.task().steps[robot.memory().step].place == box);
  robot.until_begins("squeeze");
  robot.answer = false;
  CHECK(robot.until_begins("put").place == bin);
  robot.until_begins("release");
  robot.until(Kind::finished);  // the next look answers no
  CHECK(robot.story.back() == "look");
  CHECK(robot.step().kind == Kind::finished);
}

TEST_CASE("Executor: what is lost from the hand for 50 ms is a failure, whatever the skill says") {
  Robot robot(executor);
  robot.until_begins("put");
  robot.in_hand = false;
  const auto lost = robot.now();
  robot.until_begins("reverse");  // no retry: the needs are not seen
  CHECK(robot.now() - lost >= 50ms);
  CHECK(robot.now() - lost <= 50ms + 3 * cycle);
  CHECK(robot.memory().why == StepFailure::fact_lost);
  CHECK(robot.until_begins("look").why == StepFailure::fact_lost);
  // A shorter gap is none.
  robot.until_begins("put");
  robot.in_hand = false;
  for (int i = 0; i < 11; ++i) robot.step();
  robot.in_hand = true;
  robot.until_begins("release");
}

TEST_CASE(
    "Executor: a memory that is forgiven goes back as often as a new one; one that asks waits for the "
    "answer") {
  // Each time it goes back it is forgiven: it never asks. Without that it asks after three times.
  for (const bool forgiven : {true, false}) {
    Packing::Memory m = executor.start(0ns);
    Nanoseconds now{};
    int reversed = 0;
    bool asked = false;
    std::uint16_t ticket = 0;
    for (int k = 0; k < 4000 && !asked && reversed < 10; ++k) {
      now += cycle;
      const auto out =
          executor.step(m, {.now = now, .skill = {ticket, SkillPhase::failed, SkillFailure::none}});
      const bool back = out.memory.phase == Packing::Phase::reverse && m.phase != Packing::Phase::reverse;
      reversed += back;
      m = back && forgiven ? Packing::forgiven(out.memory) : out.memory;
      if (m.phase == Packing::Phase::reverse) {  // which succeeds
        m = executor.step(m, {.now = now, .skill = {m.ticket, SkillPhase::finished, SkillFailure::none}})
                .memory;
      }
      ticket = m.ticket;
      asked = out.request.kind == Kind::ask;
    }
    CAPTURE(forgiven);
    CHECK(asked == !forgiven);
    CHECK(reversed == (forgiven ? 10 : 3));
  }
  const auto m = Packing::asking(executor.start(0ns), 1s);
  CHECK(executor.step(m, {.now = 2s}).request.kind == Kind::ask);
  CHECK(executor.step(m, {.now = 3600s}).request.kind == Kind::ask);
  const auto on = executor.step(m, {.now = 2s, .resume = true});
  CHECK(on.request.kind != Kind::ask);
  CHECK(on.memory.step ==
        (executor.task().steps[0].failed == ask_person ? 0 : executor.task().steps[0].failed));
}

TEST_CASE(
    "Executor: a step that fails is retried, then reversed, and the task looks again; in the end it asks") {
  Robot robot(executor);
  robot.failing = "reach";
  robot.failures = 1;
  robot.until_begins("take");
  CHECK(robot.story == Story{"look", "reach_above", "reach", "reach", "take"});
  robot.until_begins("release");
  robot.story.clear();
  robot.failures = 2;  // one more than it is retried
  robot.until_begins("take");
  CHECK(robot.story ==
        Story{"look", "reach_above", "reach", "reach", "reverse", "look", "reach_above", "reach", "take"});
  robot.until_begins("release");
  robot.story.clear();
  robot.failures = 1000;
  CHECK(robot.until(Kind::ask).why == StepFailure::skill);
  CHECK(std::count(robot.story.begin(), robot.story.end(), "reverse") ==
        2);  // and one of before: three in all
  for (int i = 0; i < 100; ++i) CHECK(robot.step().kind == Kind::ask);
  robot.failures = 0;
  robot.resume = true;
  robot.step();
  robot.resume = false;
  robot.until_begins("release");
}

TEST_CASE(
    "Executor: a take that closed on nothing is a failure, and so is a squeeze with an orange that is not "
    "there") {
  Robot robot(executor);
  robot.takes = false;
  robot.until_begins("reverse");
  CHECK(robot.memory().why == StepFailure::fact_missing);
  CHECK(robot.story == Story{"look", "reach_above", "reach", "take", "take", "reverse"});
  robot.takes = true;
  robot.until_begins("squeeze");
  Robot full(executor);
  full.in_hand = true;  // something is in the hand that shall take
  full.until_begins("reverse");
  CHECK(full.memory().why == StepFailure::fact_present);
}

TEST_CASE("Executor: a skill that never ends, or never begins, fails in time; one that cannot go back asks") {
  Robot robot(executor);
  robot.until_begins("reach_above");
  robot.deaf = true;
  robot.skill.phase = SkillPhase::loading;
  const auto begun = robot.now();
  robot.until_begins("reach_above");
  CHECK(robot.now() - begun >= activity::ReachAbove::rule.timeout);
  CHECK(robot.now() - begun <= activity::ReachAbove::rule.timeout + 3 * cycle);
  robot.until_begins("reverse");
  CHECK(robot.until(Kind::ask).why == StepFailure::timeout);
  // A report of another ticket is not taken for its own.
  Robot late(executor);
  late.until_begins("look");
  late.skill = {static_cast<std::uint16_t>(late.skill.ticket + 7), SkillPhase::finished, SkillFailure::none};
  CHECK(late.step().kind == Kind::start);
  CHECK(late.memory().step == packing_step::look);
}

TEST_CASE("Executor: a place that is not granted is waited for, and then given up") {
  Robot robot(executor);
  robot.until_begins("squeeze");
  robot.granted = false;
  CHECK(robot.until(Kind::wait).place == box);
  for (int i = 0; i < 1000; ++i) robot.step();
  CHECK(robot.story.back() == "squeeze");
  robot.granted = true;
  robot.until_begins("put");
  robot.until_begins("squeeze");
  robot.granted = false;
  robot.until_begins("reverse");
  CHECK(robot.memory().why == StepFailure::place);
}

TEST_CASE(
    "Executor: whatever it is told, it requests nothing whose needs are not proved, and allocates nothing") {
  auto random = seeded(9);
  Packing::Memory m = executor.start(0ns);
  Nanoseconds now{};
  std::uint64_t begun = 0;
  const AllocationGuard guard;
  {
    const RealTimeScope loop;
    for (int i = 0; i < 200000; ++i) {
      now += Nanoseconds(static_cast<std::int64_t>(random() % 60000000));
      StepInput in;
      in.now = now;
      in.seen = {{static_cast<std::uint32_t>(random() & 0x1ff)}, {}};
      in.seen.hold = Facts{static_cast<std::uint32_t>(random())} & in.seen.told;
      in.skill = {random() % 3 != 0 ? m.ticket : static_cast<std::uint16_t>(random()),
                  static_cast<SkillPhase>(random() % 4), SkillFailure::none};
      in.answer = random() % 2 == 0;
      in.granted = random() % 2 == 0;
      in.resume = random() % 8 == 0;
      const auto out = executor.step(m, in);
      const auto& r = out.request;
      const bool proved = r.kind != Kind::start || r.does == &activity::Reverse::rule ||
                          out.memory.facts.has(r.does->needs | packing_oranges.steps[r.step].needs);
      if (!proved) FAIL_CHECK("a step begins without its needs");
      begun += r.kind == Kind::start ? 1 : 0;
      m = out.memory;
      if (m.phase == Packing::Phase::finished) m = executor.start(now, m.ticket);
    }
    // Any bits in the memory.
    for (int i = 0; i < 20000; ++i) {
      unsigned char bytes[sizeof m];
      for (auto& b : bytes) b = static_cast<unsigned char>(random());
      std::memcpy(static_cast<void*>(&m), bytes, sizeof m);
      const auto out = executor.step(m, {.now = 1s});
      CHECK(out.request.step < packing_oranges.capacity);
    }
  }
  CHECK(guard.count() == 0);
  CHECK(begun > 10000);
  // Tickets begin anew, without 0.
  m = executor.start(0ns, 0xffff);
  CHECK(executor.step(m, {.now = 1s}).request.ticket == 1);
  CHECK_THROWS_AS(Packing(packing_oranges, {.lost_after = -1ns}), ConfigurationError);
  CHECK_THROWS_AS(Packing(packing_oranges, {.confirm = 11s}), ConfigurationError);
  auto wrong = packing_oranges;
  wrong.steps[packing_step::squeeze].no = packing_step::to_box;
  CHECK_THROWS_AS(Packing(wrong, {}), ConfigurationError);
  CHECK(std::string(describe(StepFailure::place)) == "the place was not granted");
}
