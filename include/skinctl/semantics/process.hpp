// SPDX-License-Identifier: BSD-3-Clause
// Tasks and processes that are proved when they are compiled.
#pragma once

#include "skinctl/semantics/task.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// A function whose call is no constant expression: the compiler stops there, and prints the line.
inline void wrong(TaskError) noexcept {}

template <std::size_t C>
[[nodiscard]] consteval TaughtTask<C> proved(TaughtTask<C> t) {
  using enum TaskError;
  switch (check(t).error) {
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
  return t;
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
  return detail::proved(t);
}

/// A process: tasks one after the other, as one task, which is proved as a whole.
template <std::size_t... N>
  requires(sizeof...(N) > 1 && (N + ...) < nowhere)
[[nodiscard]] consteval TaughtTask<(N + ...)> process(const char* name, const TaughtTask<N>&... tasks) {
  TaughtTask<(N + ...)> t{};
  t.name = name;
  bool first = true;
  const auto add = [&](const auto& next) {
    if (first) t.begins = next.begins;
    first = false;
    return append(t, next);
  };
  if (!(add(tasks) && ...)) detail::wrong(TaskError::a_task_has_no_step_or_too_many);
  return detail::proved(t);
}

SKINCTL_END_NAMESPACE
