// 30 Turn the orange: an activity of your own, and a robot of your own that can do it.
//
//   activity   what it needs, adds and removes, how long it may take; no robot in it
//   task       steps; the compiler proves that each has the facts that it needs and can be reached
//   robot      a map from activities to behaviours; the rest is in the library
#include <cstdio>

#include "skinctl/semantics/dot.hpp"
#include "skinctl/semantics/executor.hpp"
#include "skinctl/semantics/process.hpp"
#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skills/behaviours.hpp"
#include "skinctl/skills/skill_set.hpp"

using namespace skinctl;

// The activity: its label shall look up.
struct TurnOver {
  static constexpr ActivityRule rule{
      .name = "turn", .needs = fact::in_hand, .adds = fact::own<0>, .timeout = 6s, .retries = 2};
};
enum : std::uint8_t { look, above, reach, take, turn, put, release };
constexpr auto show_labels =
    task("show labels", {}, step_of<activity::Look>({.done = above, .no = finish}),
         step_of<activity::ReachAbove>({.done = reach}), step_of<activity::Reach>({.done = take}),
         step_of<activity::Take>({.done = turn}), step_of<TurnOver>({.done = put}),
         step_of<activity::Put>({.place = 0, .done = release, .needs = fact::own<0>}),
         step_of<activity::Release>({.place = 0, .done = look}));

// The robot: what it has for each activity.
struct Spin {
  static constexpr const char* name = "spin";  // a wrist that turns: a recipe of its own library
};
using Skills = Behaviours<behaviour::Reaching, behaviour::Putting, behaviour::Squeezing, Spin>;
struct MyRobot {  // in a program the type of its `skill_set(...)`
  template <class B>
  static constexpr std::uint8_t index() {
    return static_cast<std::uint8_t>(Skills::index<B>);
  }
};
constexpr auto skills = skill_map<MyRobot>(
    boost::hana::make_map(
        done_by<activity::Look, behaviour::Putting>(), done_by<activity::ReachAbove, behaviour::Reaching>(),
        done_by<activity::Reach, behaviour::Reaching>(), done_by<activity::Take, behaviour::Squeezing>(),
        done_by<activity::Put, behaviour::Putting>(), done_by<activity::Release, behaviour::Reaching>(),
        done_by<activity::Reverse, behaviour::Putting>(), done_by<TurnOver, Spin>()),
    show_labels);

// A run with skills that succeed at once, and a turn that fails twice.
int main() {
  const Executor executor(show_labels);
  auto memory = executor.start(0ns);
  SkillReport report;
  int turns = 0, requests = 0;
  for (Nanoseconds now{}; memory.phase != decltype(executor)::Phase::finished && now < 60s; now += 8ms) {
    const bool more = turns < 3;  // oranges that wait
    const auto out = executor.step(
        memory, {.now = now, .seen = {}, .skill = report, .answer = memory.step != look || more});
    memory = out.memory;
    if (out.request.kind != StepRequest::Kind::start) continue;
    const bool fails = out.request.does == &TurnOver::rule && turns++ < 2;
    report = {out.request.ticket, fails ? SkillPhase::failed : SkillPhase::finished, {}};
    std::printf("%-12s by skill %d%s\n", out.request.does->name, skills(out.request.does),
                fails ? ": fails" : "");
    ++requests;
  }
  std::printf("%d requests, %d turns; the graph has %zu bytes of DOT\n", requests, turns,
              to_dot(show_labels).size());
  return turns == 3 && memory.phase == decltype(executor)::Phase::finished ? 0 : 1;
}
