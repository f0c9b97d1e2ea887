// SPDX-License-Identifier: BSD-3-Clause
// A process: tasks one after the other, a value. Tasks and processes that are proved when they are compiled.
#pragma once

#include "skinctl/semantics/task.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// A function whose call is no constant expression: the compiler stops there, and prints the line.
inline void wrong(TaskError) noexcept {}

consteval void stop_at(TaskError error) {
  using enum TaskError;
  switch (error) {
    case none:
      break;
    case a_task_has_no_step_or_too_many:
      wrong(a_task_has_no_step_or_too_many);
      break;
    case a_step_leads_to_a_step_that_does_not_exist:
      wrong(a_step_leads_to_a_step_that_does_not_exist);
      break;
    case a_step_has_no_activity:
      wrong(a_step_has_no_activity);
      break;
    case a_step_has_a_place_or_border_that_does_not_exist:
      wrong(a_step_has_a_place_or_border_that_does_not_exist);
      break;
    case a_place_or_border_is_not_finite:
      wrong(a_place_or_border_is_not_finite);
      break;
    case a_step_cannot_be_reached:
      wrong(a_step_cannot_be_reached);
      break;
    case a_step_lacks_a_fact_that_it_needs:
      wrong(a_step_lacks_a_fact_that_it_needs);
      break;
    case a_step_may_begin_with_a_fact_that_it_forbids:
      wrong(a_step_may_begin_with_a_fact_that_it_forbids);
      break;
    case a_step_has_no_way_to_the_end:
      wrong(a_step_has_no_way_to_the_end);
      break;
  }
}
}  // namespace detail

/// A task of the given steps. One in which `check` finds a fault does not compile, and the error says why.
template <std::same_as<Step>... S>
  requires(sizeof...(S) > 0 && sizeof...(S) < nowhere)
[[nodiscard]] consteval TaughtTask<sizeof...(S)> task(const char* name, Facts begins, const S&... steps) {
  TaughtTask<sizeof...(S)> t{};
  t.name = name;
  t.begins = begins;
  t.size = sizeof...(S);
  t.steps = {steps...};
  detail::stop_at(check(t).error);
  return t;
}

/// A process of at most `N` tasks: a value, written, or loaded from files. See `join`.
///
/// A task is followed by the next one when it ends: done, with the answer no (it had nothing to do), or after
/// it has gone back. A process that repeats begins anew behind its last task, until the first one has nothing
/// to do.
template <std::size_t C, std::size_t N = 6>
struct Process {
  static_assert(N > 0 && N < 255);
  static constexpr std::size_t max_tasks = N;
  const char* name = "";
  std::uint8_t size = 0;                 ///< number of tasks
  bool repeats = false;                  ///< whether the first task follows the last one
  std::array<TaughtTask<C>, N> tasks{};  ///< the tasks, in their order
};

/// The first fault of a process: of a task by itself, or of what the tasks before it leave.
struct ProcessFault {
  std::uint8_t task = 0;  ///< index of the task
  TaskFault fault{};      ///< fault of the task, with the index of the step in it
  [[nodiscard]] constexpr bool any() const noexcept { return fault.any(); }
};

/// The tasks of a process as one task `whole`, which an executor runs, and the first fault that `check` finds
/// of a task or of the whole. Each task begins with the facts that those before it leave, or it is refused at
/// its first step. A process of more than `C` steps has `a_task_has_no_step_or_too_many`.
template <std::size_t C, std::size_t N>
[[nodiscard]] constexpr ProcessFault join(const Process<C, N>& p, TaughtTask<C>& whole) noexcept {
  whole = {};
  whole.name = p.name;
  if (p.size == 0 || p.size > N) return {0, {TaskError::a_task_has_no_step_or_too_many, 0, {}}};
  whole.begins = p.tasks[0].begins;
  std::array<std::uint8_t, N + 1> first{};
  for (std::uint8_t k = 0; k < p.size; ++k) {
    TaughtTask<C> t = p.tasks[k];
    if (const TaskFault fault = check(t); fault.any()) return {k, fault};
    if (!append(whole, t)) return {k, {TaskError::a_task_has_no_step_or_too_many, t.size, {}}};
    first[k + 1u] = whole.size;
  }
  for (std::uint8_t i = 0; p.repeats && i < whole.size; ++i) {
    Step& s = whole.steps[i];
    const bool in_first = i < first[1];
    for (std::uint8_t* to : {&s.done, &s.failed, &s.no})
      if (*to == finish) *to = 0;
    if (in_first && p.tasks[0].steps[i].no == finish) s.no = finish;
  }
  const StepFacts<C> facts = facts_of(whole);
  for (std::uint8_t k = 0; k < p.size; ++k)
    if (const Facts missing = p.tasks[k].begins - facts.holds[first[k]]; missing.any())
      return {k, {TaskError::a_step_lacks_a_fact_that_it_needs, 0, missing}};
  ProcessFault out{0, check(whole)};
  while (out.any() && out.task + 1 < p.size && out.fault.step >= first[out.task + 1u]) ++out.task;
  out.fault.step = static_cast<std::uint8_t>(out.fault.step - first[out.task]);
  return out;
}

/// The tasks of a process as one task. One in which `join` finds a fault does not compile, and the error says
/// why.
template <std::size_t C, std::size_t N>
[[nodiscard]] consteval TaughtTask<C> joined(const Process<C, N>& process) {
  TaughtTask<C> whole{};
  detail::stop_at(join(process, whole).fault.error);
  return whole;
}

SKINCTL_END_NAMESPACE
