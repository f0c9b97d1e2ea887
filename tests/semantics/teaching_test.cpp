// A sample of the study `teaching`, on other seeds: tasks found, none wrong, and what is refused.
//
// Promise: a task is learnt from one demonstration, or refused: none is wrong
// Tried: kinds of people and sensing, perturbed signals, oranges that are treated unlike. Also: study
// `teaching`
//
// Promise: the way in which a tool is used is kept with its place
// Tried: sandwiches and pancakes of simulated people: the true hand in use is within 12 mm of at most 32
// corners

#include <doctest/doctest.h>

#include "examples/worlds/demonstrations.hpp"
#include "skinctl/semantics/executor.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
constexpr std::uint64_t fresh = 9000;
constexpr int people = sanitized ? 1 : 3;
static_assert(std::is_trivially_copyable_v<Learnt<32>>);
static_assert(std::is_trivially_copyable_v<Executor<32>> &&
              std::is_trivially_copyable_v<Executor<32>::Memory>);

TaskScore score(const std::vector<Kind>& kinds, std::uint64_t first) {
  TaskScore s;
  for (const auto& kind : kinds)
    for (int i = 0; i < people; ++i)
      s.add(learn({packing_shown(kind, first + static_cast<std::uint64_t>(i))}, kitchen()));
  return s;
}
}  // namespace

TEST_CASE("learn: packing from one demonstration by sixteen kinds of people and sensing, none wrong") {
  const TaskScore s = score(kinds_of_people(), fresh);
  const int all = 16 * people;
  MESSAGE("found " << s.found << ", refused " << s.refused << " of " << all);
  CHECK(s.wrong == 0);
  CHECK(s.found >= all - (sanitized ? 1 : 2));
}

TEST_CASE("learn: signals unlike those of any person give the task or a refusal, never another task") {
  const TaskScore s = score(perturbed_signals(), fresh + 100);
  MESSAGE("found " << s.found << ", refused " << s.refused << " of " << 6 * people);
  CHECK(s.wrong == 0);
  CHECK(s.found >= 4 * people);
}

TEST_CASE(
    "learn: alike oranges treated unlike, squeezes that nobody meant, and slips are refused, with words") {
  const Kind unsqueezed{"", [](Person& p, ShownBy& by) { p.squeeze = 1, by.wander = 0.1; }};
  for (int i = 0; i < 3 * people; ++i) {
    const std::uint64_t seed = fresh + 200 + static_cast<std::uint64_t>(i);
    const auto alike = learn({alike_shown(kinds_of_people()[0], seed)}, kitchen());
    CHECK((alike.why == Refusal::unlike_without_reason || alike.why == Refusal::reason_too_small));
    CHECK(learn({packing_shown(unsqueezed, seed)}, kitchen()).why == Refusal::unlike_without_reason);
    CHECK(learn({dropped_shown(seed)}, kitchen()).why != Refusal::none);
    CHECK(std::string(describe(alike.why)).find('?') != std::string::npos);
  }
}

TEST_CASE("learn: a tool is used where its way stays; things follow each other; three demonstrations agree") {
  for (int i = 0; i < people; ++i) {
    const std::uint64_t seed = fresh + 300 + static_cast<std::uint64_t>(i);
    for (const LedTask task : {LedTask::pancake, LedTask::sandwich}) {
      const auto t = learn({kitchen_shown(task, seed, 0.003)}, kitchen());
      REQUIRE(t.why == Refusal::none);
      CHECK(in_line(t.task) == meant_in_line(task));
    }
    const Kind ordinary = kinds_of_people()[0];
    const auto three = learn({packing_shown(ordinary, seed), packing_shown(ordinary, seed + 50),
                              packing_shown(ordinary, seed + 90)},
                             kitchen());
    CHECK((three.why == Refusal::none && packs(three.task)));
  }
}

TEST_CASE(
    "taught way: a path that swings ever wider, from a hostile file, has as many corners as there is room "
    "for") {
  std::vector<Xyz<double>> path(rounds(30000));
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double x = static_cast<double>(i);
    path[i] = {1e-3 * x, i % 2 == 0 ? x : -x, 0};
  }
  const TaughtWay way = taught_way(path);
  REQUIRE((way.size >= 2 && way.size <= TaughtWay::capacity));
  CHECK(way.corners[0].y == path.front().y);
  CHECK(way.corners[way.size - 1].y == path.back().y);
}

TEST_CASE("learn: the way of a tool in use is kept, from its first stroke to its last, about its place") {
  const auto far_from_way = [](const TaughtWay& way, const Xyz<double>& p) {
    double out = 1e9;
    for (std::size_t i = 0; i + 1 < way.size; ++i) {
      const Xyz<double> off = p - way.corners[i], along = way.corners[i + 1] - way.corners[i];
      const double s = std::clamp(dot(off, along) / dot(along, along), 0.0, 1.0);
      out = std::min(out, norm(Xyz<double>(off - s * along)));
    }
    return out;
  };
  for (int i = 0; i < 2 * people; ++i)
    for (const LedTask task : {LedTask::sandwich, LedTask::pancake}) {
      const std::uint64_t seed = fresh + 500 + static_cast<std::uint64_t>(i);
      auto random = seeded(seed);
      const LedRun run = led_run(task, Person::any(random), seed);
      const auto demonstration = shown(run, {}, seed + 1);
      const auto t = learn({demonstration}, kitchen());
      const auto deeds = deeds_of(demonstration, kitchen().deeds);
      REQUIRE((t.why == Refusal::none && deeds.why == Refusal::none));
      std::size_t ways = 0;
      for (const TaughtWay& way : t.ways) ways += way.size > 0;
      CHECK(ways == (task == LedTask::sandwich ? 1 : 2));
      // The hand while the person means to use the tool lies on the way, and the way does not go elsewhere.
      for (const auto& episode : deeds.episodes)
        for (const auto& deed : episode) {
          if (deed.verb != Verb::use) continue;
          double most = 0, longest = 0;
          for (int k = 0; k < 4000; ++k) {
            const double time = 0.01 * k;
            const double off = std::abs(time - seconds<double>(deed.time));
            if (off > 5 || run.hand.intent(time) != Activity::use) continue;
            most = std::max(most, far_from_way(deed.way, run.hand.truth(time).p - deed.at(0).X_MH.origin()));
          }
          for (std::size_t k = 0; k < deed.way.size; ++k)
            longest = std::max(longest, norm(deed.way.corners[k]));
          CHECK(most < 0.012);
          CHECK(longest < 0.13);
          CHECK(deed.way.size > 8);
        }
    }
}

TEST_CASE("learn: recordings that are none are refused, and say which") {
  const auto good = packing_shown(kinds_of_people()[0], fresh);
  const auto refused = [](const Demonstration<>& d) { return learn({d}, kitchen()).why; };
  CHECK(learn(std::vector<Demonstration<>>{}).why == Refusal::not_a_recording);
  CHECK(refused({}) == Refusal::not_a_recording);
  auto d = good;
  d.hand[100].force = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(d) == Refusal::not_a_recording);
  d = good;
  d.hand[100].time = d.hand[99].time;
  CHECK(refused(d) == Refusal::not_a_recording);
  d = good;
  d.seen[5].object = 200;
  CHECK(refused(d) == Refusal::not_a_recording);
  d = good;
  for (auto& x : d.hand) x.force = 0;
  CHECK(refused(d) == Refusal::nothing_taken);
  d = good;
  d.seen.clear();
  CHECK(refused(d) == Refusal::thing_unknown);
  d = good;  // begins in the middle of the first contact
  const auto cut = segments_of(d.hand).contacts.at(0).span;
  d.hand.erase(d.hand.begin(), d.hand.begin() + static_cast<std::ptrdiff_t>((cut.begin + cut.end) / 2));
  CHECK(refused(d) == Refusal::hand_not_empty);
  d = good;  // nothing measures the opening of the fingers
  for (auto& x : d.hand) x.opening = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(d) == Refusal::unlike_without_reason);
  CHECK(learn<6>({good}, kitchen()).why == Refusal::too_long);
}

TEST_CASE("learn: whatever is recorded gives a task that is proved, or words") {
  auto random = seeded(77);
  int proved = 0;
  for (int i = 0; i < (sanitized ? 10 : 100); ++i) {
    Demonstration<> d = packing_shown(kinds_of_people()[random() % 16], fresh + 400 + random() % 3);
    for (std::uint64_t k = 1 + random() % 3; k > 0; --k) {
      const std::size_t from = random() % d.hand.size(), to = std::min(d.hand.size(), from + random() % 800);
      const auto what = random() % 4;
      for (std::size_t j = from; j < to; ++j) {
        if (what == 0) d.hand[j].force = 0;
        if (what == 1) d.hand[j].force *= 2;
        if (what == 2) d.hand[j].X_WH = d.hand[from].X_WH;
        if (what == 3) d.hand[j].opening = 0.01;
      }
    }
    auto learnt = learn({d}, kitchen());
    if (learnt.why == Refusal::none) {
      ++proved;
      CHECK_FALSE(check(learnt.task).any());
    }
  }
  CHECK(proved > 0);
}
