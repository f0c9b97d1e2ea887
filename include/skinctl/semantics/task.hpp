// SPDX-License-Identifier: BSD-3-Clause
// A task: a graph of steps, a value that is proved when it is compiled, or when it is learnt or loaded.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "skinctl/semantics/activity.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Values of `Step::done`, `failed` and `no` that name no step.
inline constexpr std::uint8_t finish = 254;      ///< the task is done
inline constexpr std::uint8_t ask_person = 253;  ///< a person is asked to look
inline constexpr std::uint8_t nowhere = 252;     ///< the answer no of the step is a failure

/// Value of `Step::place` without a place: the step acts where the hand or the object is.
inline constexpr std::uint8_t no_place = 255;
/// Value of `Step::border` without a border: the step's answer is that of its skill.
inline constexpr std::uint8_t no_border = 255;

/// One step of a task: an activity with an object's role and a place, and the steps that follow.
struct Step {
  const ActivityRule* does = nullptr;
  std::uint8_t role = 0;            ///< class of the object that the step is about
  std::uint8_t place = no_place;    ///< number of a `TaughtPlace`, or what the application calls "box", "bin"
  std::uint8_t done = finish;       ///< next step after success, and where the answer is yes
  std::uint8_t failed = 0;          ///< step after a failure, once the robot has gone back; it needs no fact
  std::uint8_t no = nowhere;        ///< next step when the answer is no
  std::uint8_t border = no_border;  ///< index of a border; answer yes: the felt stiffness is not below it
  Facts needs{};                    ///< facts that the step needs besides those of the activity
};
template <PlannedActivity A>
[[nodiscard]] constexpr Step step_of(Step step) noexcept {
  step.does = &A::rule;
  return step;
}

/// A place of the hand, relative to a landmark.
struct TaughtPlace {
  ObjectClass mark = 0;                 ///< class of the landmark M; 0: the world
  Transform<ObjectFrame, Tool> X_MH{};  ///< pose of the hand in the landmark's frame
};

/// A task of at most `C` steps, as it is written, taught or loaded: a value, trivially copyable. See `check`.
template <std::size_t C>
struct TaughtTask {
  static_assert(C > 0 && C < nowhere, "1 to 251 steps");
  static constexpr std::size_t capacity = C;
  static constexpr std::size_t max_places = 8, max_borders = 4;
  const char* name = "";
  std::uint8_t size = 0;                         ///< number of steps
  std::uint8_t place_count = 0;                  ///< number of taught places; 0: places are the application's
  std::uint8_t border_count = 0;                 ///< number of borders
  Facts begins{};                                ///< facts that hold when the task begins
  Facts ends{};                                  ///< facts that hold when the task has ended; set by `check`
  std::array<Step, C> steps{};                   ///< the steps; the task begins with the first
  std::array<TaughtPlace, max_places> places{};  ///< places where hands take, put and use
  std::array<double, max_borders> borders{};     ///< borders of the stiffness that a squeeze feels [N/m]
};

/// The fault of a task.
enum class TaskError : std::uint8_t {
  none,
  a_task_has_no_step_or_too_many,
  a_step_leads_to_a_step_that_does_not_exist,
  a_step_has_no_activity,
  a_step_has_a_place_or_border_that_does_not_exist,
  a_place_or_border_is_not_finite,
  a_step_cannot_be_reached,
  a_step_lacks_a_fact_that_it_needs,
  a_step_may_begin_with_a_fact_that_it_forbids,
  a_step_has_no_way_to_the_end
};
[[nodiscard]] constexpr const char* describe(TaskError error) noexcept {
  constexpr const char* texts[] = {"nothing is wrong",
                                   "the task has no step, or too many",
                                   "the step leads to one that does not exist",
                                   "the step has no activity",
                                   "the step has a place or a border that does not exist",
                                   "a place or a border is not finite, or a border is not above 0",
                                   "the step cannot be reached",
                                   "the step lacks a fact that it needs",
                                   "the step may begin with a fact that it forbids",
                                   "the step has no way to the end"};
  const auto i = static_cast<std::size_t>(error);
  return i < std::size(texts) ? texts[i] : "";
}
/// The first fault of a task that `check` finds: of its parts first, then of the proof, step by step.
struct TaskFault {
  TaskError error = TaskError::none;
  std::uint8_t step = 0;
  Facts facts{};  ///< the facts that are missing, or that are there and forbidden
  [[nodiscard]] constexpr bool any() const noexcept { return error != TaskError::none; }
};

/// The facts that are proved to hold when each of C steps begins, and those that may hold then.
template <std::size_t C>
struct StepFacts {
  std::array<Facts, C> holds{}, may_hold{};
  std::array<bool, C> reached{};
  Facts ends{};
};

namespace detail {
/// The facts after a step, from the facts `before` it; `no`: its answer is no.
[[nodiscard]] constexpr Facts after(const ActivityRule& a, Facts before, bool no) noexcept {
  return (before - a.removes) | (no ? a.adds_if_no : a.adds);
}

/// The first fault of a task's parts: a step, an edge or a number that does not exist, or is out of range.
template <std::size_t C>
[[nodiscard]] constexpr TaskFault check_parts(const TaughtTask<C>& t) noexcept {
  if (t.size == 0 || t.size > C) return {TaskError::a_task_has_no_step_or_too_many, t.size, {}};
  const auto exists = [&t](std::uint8_t to, bool may_be_nowhere) {
    return to < t.size || to == finish || to == ask_person || (may_be_nowhere && to == nowhere);
  };
  const bool counts = t.place_count <= t.max_places && t.border_count <= t.max_borders;
  for (std::uint8_t i = 0; i < t.size; ++i) {
    const Step& s = t.steps[i];
    if (s.does == nullptr) return {TaskError::a_step_has_no_activity, i, {}};
    if (!exists(s.done, false) || !exists(s.failed, false) || !exists(s.no, true))
      return {TaskError::a_step_leads_to_a_step_that_does_not_exist, i, {}};
    const bool place = s.place == no_place || t.place_count == 0 || s.place < t.place_count;
    if (!counts || !place || (s.border != no_border && s.border >= t.border_count))
      return {TaskError::a_step_has_a_place_or_border_that_does_not_exist, i, {}};
  }
  for (std::uint8_t i = 0; i < t.place_count; ++i) {
    const auto& p = t.places[i].X_MH.origin();
    if (!(p.x * p.x + p.y * p.y + p.z * p.z <= 1e12 && rotation_error(t.places[i].X_MH.axes()) <= 1e-6))
      return {TaskError::a_place_or_border_is_not_finite, i, {}};
  }
  for (std::uint8_t i = 0; i < t.border_count; ++i)
    if (!(t.borders[i] > 0 && t.borders[i] <= 1e12))
      return {TaskError::a_place_or_border_is_not_finite, i, {}};
  return {};
}
/// The first step from which no edge done or no leads to the end; `size`: none.
template <std::size_t C>
[[nodiscard]] constexpr std::uint8_t without_end(const TaughtTask<C>& t) noexcept {
  std::array<bool, C> ends{};
  for (bool changes = true; changes;) {
    changes = false;
    for (std::size_t i = 0; i < t.size; ++i) {
      const auto leads = [&](std::uint8_t to) { return to == finish || (to < t.size && ends[to]); };
      if (!ends[i] && (leads(t.steps[i].done) || leads(t.steps[i].no))) changes = ends[i] = true;
    }
  }
  for (std::uint8_t i = 0; i < t.size; ++i)
    if (!ends[i]) return i;
  return t.size;
}
}  // namespace detail

/// The facts that hold, and that may hold, before each step of a task whose edges exist: the fixed point over
/// all edges, which is reached after at most 64 rounds per step. After a failure the facts are unknown: none
/// is proved, so the step that follows needs none; the sensors tell which of them hold.
template <std::size_t C>
[[nodiscard]] constexpr StepFacts<C> facts_of(const TaughtTask<C>& t) noexcept {
  StepFacts<C> out{};
  const Facts all{~std::uint32_t(0)};
  out.holds.fill(all);
  out.holds[0] = out.may_hold[0] = t.begins;
  out.ends = all;
  out.reached[0] = true;
  for (bool changes = true; changes;) {
    changes = false;
    const auto flow = [&](std::uint8_t to, Facts holds, Facts may) {
      if (to == finish) out.ends = out.ends & holds;
      if (to >= t.size) return;
      const Facts meet = out.holds[to] & holds, join = out.may_hold[to] | may;
      changes = changes || !out.reached[to] || !(meet == out.holds[to]) || !(join == out.may_hold[to]);
      out.reached[to] = true;
      out.holds[to] = meet;
      out.may_hold[to] = join;
    };
    for (std::size_t i = 0; i < t.size; ++i) {
      if (!out.reached[i]) continue;
      const Step& s = t.steps[i];
      const Facts holds = out.holds[i], may = out.may_hold[i];
      flow(s.done, detail::after(*s.does, holds, false), detail::after(*s.does, may, false));
      if (s.no != nowhere) flow(s.no, detail::after(*s.does, holds, true), detail::after(*s.does, may, true));
      if (s.failed != finish) flow(s.failed, {}, {});
    }
  }
  return out;
}

/// Proves a task, when it is compiled or at run time: sets `ends`, and returns the first fault or none.
///
/// Proved for every way through the graph, over the edges done, no and failed: each step can be reached, has
/// a way to the end, and begins with the facts that it needs. After a failure nothing is taken for granted:
/// the step that follows needs no fact ("a failed step looks again"). Over done and no: no step can begin
/// with a fact that it forbids.
template <std::size_t C>
[[nodiscard]] constexpr TaskFault check(TaughtTask<C>& t) noexcept {
  if (const TaskFault fault = detail::check_parts(t); fault.any()) return fault;
  const StepFacts<C> facts = facts_of(t);
  t.ends = facts.ends;
  for (std::uint8_t i = 0; i < t.size; ++i) {
    const Step& s = t.steps[i];
    const Facts missing = (s.does->needs | s.needs) - facts.holds[i];
    const Facts present = facts.may_hold[i] & s.does->forbids;
    if (!facts.reached[i]) return {TaskError::a_step_cannot_be_reached, i, {}};
    if (missing.any()) return {TaskError::a_step_lacks_a_fact_that_it_needs, i, missing};
    if (present.any()) return {TaskError::a_step_may_begin_with_a_fact_that_it_forbids, i, present};
  }
  if (const std::uint8_t i = detail::without_end(t); i < t.size)
    return {TaskError::a_step_has_no_way_to_the_end, i, {}};
  return {};
}

/// Appends the steps of `next` to those of `t`, which goes on there instead of finishing. Returns false, and
/// changes nothing, if they do not fit. The result has to be checked again.
template <std::size_t C, std::size_t M>
[[nodiscard]] constexpr bool append(TaughtTask<C>& t, TaughtTask<M> next) noexcept {
  const std::size_t by = t.size, places = t.place_count, borders = t.border_count;
  if (by + next.size > C || places + next.place_count > t.max_places ||
      borders + next.border_count > t.max_borders)
    return false;
  const auto moved = [by](std::uint8_t to) { return to < nowhere ? static_cast<std::uint8_t>(to + by) : to; };
  const auto behind = [by](std::uint8_t to) { return to == finish ? static_cast<std::uint8_t>(by) : to; };
  for (std::size_t i = 0; i < by; ++i) {
    Step& s = t.steps[i];
    s.done = behind(s.done), s.no = behind(s.no), s.failed = behind(s.failed);
  }
  for (std::size_t i = 0; i < next.size; ++i) {
    Step s = next.steps[i];
    s.done = moved(s.done), s.no = moved(s.no), s.failed = moved(s.failed);
    if (s.place != no_place && next.place_count > 0) s.place = static_cast<std::uint8_t>(s.place + places);
    if (s.border != no_border) s.border = static_cast<std::uint8_t>(s.border + borders);
    t.steps[by + i] = s;
  }
  for (std::size_t i = 0; i < next.place_count; ++i) t.places[places + i] = next.places[i];
  for (std::size_t i = 0; i < next.border_count; ++i) t.borders[borders + i] = next.borders[i];
  t.size = static_cast<std::uint8_t>(by + next.size);
  t.place_count = static_cast<std::uint8_t>(places + next.place_count);
  t.border_count = static_cast<std::uint8_t>(borders + next.border_count);
  return true;
}

SKINCTL_END_NAMESPACE
