// A task: a graph of steps, proved when it is compiled.
#pragma once

#include <array>
#include <cstddef>

#include "skinctl/semantics/activity.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Where a step leads besides to another step.
inline constexpr std::uint8_t finish = 254;      ///< the task is done
inline constexpr std::uint8_t ask_person = 253;  ///< somebody has to look
inline constexpr std::uint8_t nowhere = 252;     ///< an answer no of this step is a failure

/// No place: the step acts where the hand or the object is.
inline constexpr std::uint8_t no_place = 255;

/// One step of a task: an activity with an object's role and a place, and the steps that follow.
struct Step {
  const ActivityRule* does = nullptr;
  std::uint8_t role = 0;          ///< the class of the object that it is about
  std::uint8_t place = no_place;  ///< a number that the application gives to "box", "bin"
  std::uint8_t done = finish;     ///< next step
  std::uint8_t failed = 0;        ///< next step when it has failed, after going back: one that needs nothing
  std::uint8_t no = nowhere;      ///< next step when the answer is no
  Facts needs{};                  ///< besides those of the activity
};
template <PlannedActivity A>
[[nodiscard]] constexpr Step step_of(Step step) noexcept {
  step.does = &A::rule;
  return step;
}

/// A checked task: see `task`.
template <std::size_t N>
struct Task {
  static constexpr std::size_t steps_count = N;
  const char* name = "";
  Facts begins{};             ///< hold when it begins
  std::array<Step, N> steps;  ///< the task begins with the first
  /// What is proved to hold when a step begins, and what may hold.
  std::array<Facts, N> holds{}, may_hold{};
  Facts ends{};  ///< hold whenever it is finished
};

/// Errors of a task. They are no constant expressions: the compiler stops, and prints the name.
namespace task_error {
inline void a_step_leads_to_a_step_that_does_not_exist(std::size_t) {}
inline void a_step_has_no_activity(std::size_t) {}
inline void a_step_lacks_a_fact_that_it_needs(std::size_t) {}
inline void a_step_may_begin_with_a_fact_that_it_forbids(std::size_t) {}
inline void a_step_cannot_be_reached(std::size_t) {}
inline void a_step_has_no_way_to_the_end(std::size_t) {}
inline void a_task_begins_without_the_facts_that_it_needs(std::size_t) {}
}  // namespace task_error

namespace detail {
/// The facts behind a step's edges, of a set that holds before it.
[[nodiscard]] constexpr Facts after(const ActivityRule& a, Facts before, bool no) noexcept {
  return (before - a.removes) | (no ? a.adds_if_no : a.adds);
}

template <std::size_t N>
constexpr void check_edges(const Task<N>& t) {
  const auto exists = [](std::uint8_t to, bool may_be_nowhere) {
    return to < N || to == finish || to == ask_person || (may_be_nowhere && to == nowhere);
  };
  for (std::size_t i = 0; i < N; ++i) {
    const Step& s = t.steps[i];
    if (s.does == nullptr) task_error::a_step_has_no_activity(i);
    if (!exists(s.done, false) || !exists(s.failed, false) || !exists(s.no, true))
      task_error::a_step_leads_to_a_step_that_does_not_exist(i);
  }
}

/// What holds, and may hold, before each step: the fixed point over all edges. What is left of facts after a failure
/// is unknown: none is proved, so the step that follows needs none; what may hold then is for the sensors to tell.
template <std::size_t N>
constexpr void find_facts(Task<N>& t, std::array<bool, N>& reached) {
  const Facts all{~std::uint32_t(0)};
  t.holds.fill(all);
  t.holds[0] = t.may_hold[0] = t.begins;
  t.ends = all;
  reached[0] = true;
  for (bool changes = true; changes;) {
    changes = false;
    const auto flow = [&](std::uint8_t to, Facts holds, Facts may) {
      if (to == finish) t.ends = t.ends & holds;
      if (to >= N) return;
      const Facts meet = t.holds[to] & holds, join = t.may_hold[to] | may;
      changes = changes || !reached[to] || !(meet == t.holds[to]) || !(join == t.may_hold[to]);
      reached[to] = true;
      t.holds[to] = meet;
      t.may_hold[to] = join;
    };
    for (std::size_t i = 0; i < N; ++i) {
      if (!reached[i]) continue;
      const Step& s = t.steps[i];
      flow(s.done, after(*s.does, t.holds[i], false), after(*s.does, t.may_hold[i], false));
      if (s.no != nowhere) flow(s.no, after(*s.does, t.holds[i], true), after(*s.does, t.may_hold[i], true));
      if (s.failed != finish) flow(s.failed, {}, {});
    }
  }
}

template <std::size_t N>
constexpr void check_ends(const Task<N>& t) {
  std::array<bool, N> ends{};
  for (bool changes = true; changes;) {
    changes = false;
    for (std::size_t i = 0; i < N; ++i) {
      const auto leads = [&](std::uint8_t to) { return to == finish || (to < N && ends[to]); };
      if (!ends[i] && (leads(t.steps[i].done) || leads(t.steps[i].no))) changes = ends[i] = true;
    }
  }
  for (std::size_t i = 0; i < N; ++i)
    if (!ends[i]) task_error::a_step_has_no_way_to_the_end(i);
}

template <std::size_t N>
constexpr Task<N> proved(Task<N> t) {
  check_edges(t);
  std::array<bool, N> reached{};
  find_facts(t, reached);
  for (std::size_t i = 0; i < N; ++i) {
    const Step& s = t.steps[i];
    if (!reached[i]) task_error::a_step_cannot_be_reached(i);
    if (!t.holds[i].has(s.does->needs | s.needs)) task_error::a_step_lacks_a_fact_that_it_needs(i);
    if ((t.may_hold[i] & s.does->forbids).any()) task_error::a_step_may_begin_with_a_fact_that_it_forbids(i);
  }
  check_ends(t);
  return t;
}
}  // namespace detail

/// A task of these steps, if it is right; a wrong one does not compile, and the error says why.
///
/// Proved for every way through the graph, over the edges done, no and failed: each step can be reached, has a way
/// to the end, and begins with the facts that it needs. After a failure nothing is taken for granted: the step
/// that follows needs no fact ("a failed step looks again"). Over done and no: no step can begin with a fact that it
/// forbids.
template <std::same_as<Step>... S>
  requires(sizeof...(S) > 0 && sizeof...(S) < nowhere)
[[nodiscard]] consteval Task<sizeof...(S)> task(const char* name, Facts begins, const S&... steps) {
  Task<sizeof...(S)> t{};
  t.name = name;
  t.begins = begins;
  t.steps = {steps...};
  return detail::proved(t);
}

/// A process: tasks one after the other. It is a task again, and proved as one: what the first proves when it ends
/// is what the second begins with.
template <std::size_t N, std::size_t M>
  requires(N + M < nowhere)
[[nodiscard]] consteval Task<N + M> process(const char* name, const Task<N>& first, const Task<M>& second) {
  if (!first.ends.has(second.begins)) task_error::a_task_begins_without_the_facts_that_it_needs(N);
  Task<N + M> t{};
  t.name = name;
  t.begins = first.begins;
  const auto moved = [](std::uint8_t to, std::size_t by, std::uint8_t end) {
    return to == finish ? end : to < nowhere ? static_cast<std::uint8_t>(to + by) : to;
  };
  for (std::size_t i = 0; i < N + M; ++i) {
    Step s = i < N ? first.steps[i] : second.steps[i - N];
    const std::size_t by = i < N ? 0 : N;
    const std::uint8_t end = i < N ? static_cast<std::uint8_t>(N) : finish;
    s.done = moved(s.done, by, end);
    s.no = moved(s.no, by, end);
    s.failed = moved(s.failed, by, end);
    t.steps[i] = s;
  }
  return detail::proved(t);
}
template <std::size_t N, std::size_t M, std::size_t... More>
[[nodiscard]] consteval auto process(const char* name, const Task<N>& first, const Task<M>& second,
                                     const Task<More>&... more)
  requires(sizeof...(More) > 0)
{
  return process(name, process(name, first, second), more...);
}

SKINCTL_END_NAMESPACE
