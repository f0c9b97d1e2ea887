// SPDX-License-Identifier: BSD-3-Clause
// Executes a task: from what is seen and what the skill reports to the next request. A pure function.
#pragma once

#include "skinctl/semantics/task.hpp"
#include "skinctl/skills/skill.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The reason for which a step has failed.
enum class StepFailure : std::uint8_t {
  none,
  skill,         ///< the skill reported a failure, see `SkillReport::failure`
  timeout,       ///< the skill did not end in time
  fact_lost,     ///< a fact that the step needs was seen to hold no more
  fact_missing,  ///< a needed fact was not seen at the begin, or an added one at the end
  fact_present,  ///< a forbidden fact was seen at the begin
  no_answer,     ///< the answer was no, and the task has no edge for it
  place          ///< the place was not granted in time
};
[[nodiscard]] constexpr const char* describe(StepFailure failure) noexcept {
  constexpr const char* texts[] = {"has not failed",
                                   "the skill failed",
                                   "not ended in time",
                                   "lost what it needs",
                                   "what it needs or adds is not seen",
                                   "what it forbids is seen",
                                   "the answer is no",
                                   "the place was not granted"};
  const auto i = static_cast<std::size_t>(failure);
  return i < std::size(texts) ? texts[i] : "";
}

/// A request of an executor to a robot.
struct StepRequest {
  enum class Kind : std::uint8_t {
    wait,     ///< nothing, until the place is granted
    start,    ///< start `does` with `ticket`; asked until a report has that ticket
    go_on,    ///< go on with the started step
    ask,      ///< call a person; the robot holds
    finished  ///< the task is done; the robot holds
  };
  Kind kind = Kind::wait;
  StepFailure why = StepFailure::none;  ///< reason of the last failure
  std::uint8_t step = 0;
  std::uint8_t role = 0;
  std::uint8_t place = no_place;
  std::uint16_t ticket = 0;
  const ActivityRule* does = nullptr;  ///< the activity; `activity::Reverse` on the way back
};

/// The input of an executor in a cycle.
struct StepInput {
  Nanoseconds now{};
  Observed seen{};
  SkillReport skill{};
  bool answer = true;   ///< answer of a finished skill that decides something: yes or no
  bool granted = true;  ///< whether the place of the step is granted to this robot
  bool resume = false;  ///< a person has looked: begin anew with the step that follows the failure
};

/// Settings of an executor.
struct ExecutorSettings {
  Nanoseconds lost_after = 50ms;  ///< time without being seen to hold after which a needed fact is lost
  Nanoseconds confirm =
      300ms;  ///< longest time after the end of a skill until its added and removed facts are seen
  Nanoseconds max_place_wait = 30s;  ///< longest wait for a place
  std::uint8_t max_reverses = 3;     ///< number of times that a task goes back before it asks a person
};

/// Executes a task. Immutable; `step` is a pure function from a memory of 24 bytes to a request and the next
/// memory.
///
/// A step begins when the facts that it needs are proved (by the task) and, where sensors tell them, seen.
/// They are watched while it runs: one gone for `lost_after` is a failure, whatever the skill reports. When
/// the skill has ended, what the step adds and removes is confirmed by what is seen.
///
/// A step that fails begins anew `retries` times if its needs are still seen; then the robot goes back (the
/// activity `Reverse`), and the task goes on with the step's `failed`. A task that went back `max_reverses`
/// times, or that fails to go back, asks a person, and so does one whose `failed` is `ask_person`.
template <std::size_t N>
class Executor {
 public:
  enum class Phase : std::uint8_t { begin, run, confirm, begin_reverse, reverse, ask, finished };
  struct Memory {
    Nanoseconds since{};       ///< time at which the present phase began
    Facts facts{};             ///< facts that hold by what has been done
    std::uint32_t unseen = 0;  ///< time at which the needed facts were seen last, from `since` on [us]
    std::uint16_t ticket = 0;  ///< number of the last request
    std::uint8_t step = 0;
    Phase phase : 4 = Phase::begin;
    StepFailure why : 4 = StepFailure::none;
    std::uint8_t tries = 0, reverses = 0;
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };
  struct Result {
    StepRequest request;
    Memory memory;
  };

  /// Throws `ConfigurationError` for a task that `check` refuses, and for a number out of its range.
  SKINCTL_COLD explicit Executor(const TaughtTask<N>& task, const ExecutorSettings& s = {})
      : task_(task), s_(s) {
    const TaskFault fault = check(task_);
    require(!fault.any(), describe(fault.error), fault.step,
            "a task that check() proves; the number is the step's");
    require(s.lost_after >= 0ns && s.lost_after <= 10s, "Executor: lost_after", milliseconds(s.lost_after),
            "0 to 1e4 ms");
    require(s.confirm >= 0ns && s.confirm <= 10s, "Executor: confirm", milliseconds(s.confirm),
            "0 to 1e4 ms");
    require(s.max_place_wait >= 0ns && s.max_place_wait <= 1000s, "Executor: max_place_wait",
            milliseconds(s.max_place_wait), "0 to 1e6 ms");
  }
  [[nodiscard]] const TaughtTask<N>& task() const noexcept { return task_; }
  /// The memory with which the task begins, at the instant `now`. Tickets count on from `ticket`.
  [[nodiscard]] Memory start(Nanoseconds now, std::uint16_t ticket = 0) const noexcept {
    Memory m;
    m.since = now;
    m.facts = task_.begins;
    m.ticket = ticket;
    return m;
  }

  /// `m` with its count of ways back at 0: for a failure that the world has explained.
  [[nodiscard]] static Memory forgiven(Memory m) noexcept {
    m.reverses = 0;
    return m;
  }
  /// `m` that calls a person from `now` on; with `resume` it goes on as after a failure of its step.
  [[nodiscard]] static Memory asking(Memory m, Nanoseconds now) noexcept {
    to(m, now, Phase::ask);
    return m;
  }

  [[nodiscard]] Result step(Memory m, const StepInput& in) const noexcept {
    static_assert(sizeof(Memory) == 24 && std::is_trivially_copyable_v<Memory>);
    if (m.step >= task_.size) enter(m, in.now, 0);  // any bits are allowed in a memory
    const ActivityRule& rule = *task_.steps[m.step].does;
    switch (m.phase) {
      case Phase::begin:
        begin(m, in, rule);
        break;
      case Phase::run:
        run(m, in, rule);
        break;
      case Phase::confirm:
        confirm(m, in, rule);
        break;
      case Phase::begin_reverse:
        number(m);
        to(m, in.now, Phase::reverse);
        break;
      case Phase::reverse:
        reverse(m, in);
        break;
      case Phase::ask:
        if (in.resume) {
          m.reverses = 0;
          follow_edge(m, in.now,
                      task_.steps[m.step].failed == ask_person ? std::uint8_t(0) : task_.steps[m.step].failed,
                      {});
        }
        break;
      default:
        break;
    }
    return {request(m, in), m};
  }

 private:
  static void to(Memory& m, Nanoseconds now, Phase phase) noexcept {
    m.phase = phase;
    m.since = now;
    m.unseen = 0;
  }
  /// Counts up the ticket; 0 is none.
  static void number(Memory& m) noexcept {
    m.ticket = m.ticket == 0xffff ? std::uint16_t(1) : std::uint16_t(m.ticket + 1);
  }
  static void enter(Memory& m, Nanoseconds now, std::uint8_t step) noexcept {
    m.step = step;
    m.tries = 0;
    to(m, now, Phase::begin);
  }
  /// Follows an edge with the facts behind it: to the step `next`, to the end, or to a question.
  void follow_edge(Memory& m, Nanoseconds now, std::uint8_t next, Facts facts) const noexcept {
    m.facts = facts;
    if (next < task_.size) return enter(m, now, next);
    if (next == finish) m.reverses = 0;
    to(m, now, next == finish ? Phase::finished : Phase::ask);
  }
  [[nodiscard]] Facts needs(const Memory& m) const noexcept {
    return task_.steps[m.step].does->needs | task_.steps[m.step].needs;
  }
  /// Whether something has not been seen for `limit` or longer; the phase began at `m.since`.
  static bool unseen_for(Memory& m, const StepInput& in, bool seen, Nanoseconds limit) noexcept {
    // The instant when it was last seen, relative to the start of the phase: 32 bits of microseconds last an
    // hour.
    const auto us = static_cast<std::uint64_t>((in.now - m.since).count()) / 1000;
    const auto now = static_cast<std::uint32_t>(us < 0xffffffffu ? us : 0xffffffffu);
    if (seen) m.unseen = now;
    return !seen && now - m.unseen >= static_cast<std::uint64_t>(limit.count()) / 1000;
  }
  void fail(Memory& m, const StepInput& in, StepFailure why, bool again) const noexcept {
    m.why = why;
    const ActivityRule& rule = *task_.steps[m.step].does;
    if (again && m.tries < rule.retries && in.seen.hold.has(needs(m) & in.seen.told)) {
      ++m.tries;
      return to(m, in.now, Phase::begin);
    }
    if (m.reverses >= s_.max_reverses) return to(m, in.now, Phase::ask);
    ++m.reverses;
    to(m, in.now, Phase::begin_reverse);
  }

  void begin(Memory& m, const StepInput& in, const ActivityRule& rule) const noexcept {
    if (!m.facts.has(needs(m))) return fail(m, in, StepFailure::fact_missing, false);
    const bool needed = in.seen.hold.has(needs(m) & in.seen.told);
    const bool forbidden = (in.seen.hold & rule.forbids).any();
    if (!needed || forbidden) {
      if (unseen_for(m, in, false, s_.lost_after))
        fail(m, in, needed ? StepFailure::fact_present : StepFailure::fact_missing, false);
      return;
    }
    if (task_.steps[m.step].place != no_place && !in.granted) {
      if (in.now - m.since >= s_.max_place_wait) fail(m, in, StepFailure::place, false);
      return;
    }
    number(m);
    to(m, in.now, Phase::run);
  }
  void run(Memory& m, const StepInput& in, const ActivityRule& rule) const noexcept {
    const Facts watched = (needs(m) - rule.removes) & in.seen.told;
    if (unseen_for(m, in, in.seen.hold.has(watched), s_.lost_after))
      return fail(m, in, StepFailure::fact_lost, true);
    if (in.skill.ticket == m.ticket && in.skill.phase == SkillPhase::failed)
      return fail(m, in, StepFailure::skill, true);
    if (in.skill.ticket == m.ticket && in.skill.phase == SkillPhase::finished) {
      if (!in.answer && task_.steps[m.step].no == nowhere) return fail(m, in, StepFailure::no_answer, true);
      to(m, in.now, Phase::confirm);
      return confirm(m, in, rule);
    }
    if (in.now - m.since >= rule.timeout) fail(m, in, StepFailure::timeout, true);
  }
  /// Waits until the effects of the step are seen. The answer of the report is read in this phase as well.
  void confirm(Memory& m, const StepInput& in, const ActivityRule& rule) const noexcept {
    const bool no = !in.answer && task_.steps[m.step].no != nowhere;
    const Facts now = detail::after(rule, m.facts, no);
    const Facts added = (no ? rule.adds_if_no : rule.adds) & in.seen.told;
    const bool seen = in.seen.hold.has(added) && !(in.seen.hold & (rule.removes - added)).any();
    if (seen) return follow_edge(m, in.now, no ? task_.steps[m.step].no : task_.steps[m.step].done, now);
    if (in.now - m.since >= s_.confirm) fail(m, in, StepFailure::fact_missing, true);
  }
  void reverse(Memory& m, const StepInput& in) const noexcept {
    if (in.skill.ticket == m.ticket && in.skill.phase == SkillPhase::finished)
      return follow_edge(m, in.now, task_.steps[m.step].failed, {});
    if ((in.skill.ticket == m.ticket && in.skill.phase == SkillPhase::failed) ||
        in.now - m.since >= activity::Reverse::rule.timeout)
      to(m, in.now, Phase::ask);
  }

  [[nodiscard]] StepRequest request(const Memory& m, const StepInput& in) const noexcept {
    const Step& s = task_.steps[m.step];
    StepRequest r{StepRequest::Kind::wait, m.why, m.step, s.role, s.place, m.ticket, s.does};
    using Kind = StepRequest::Kind;
    switch (m.phase) {
      case Phase::reverse:
        r.does = &activity::Reverse::rule;
        [[fallthrough]];
      case Phase::run:
        r.kind = in.skill.ticket == m.ticket ? Kind::go_on : Kind::start;
        break;
      case Phase::confirm:
        r.kind = Kind::go_on;
        break;
      case Phase::ask:
        r.kind = Kind::ask;
        break;
      case Phase::finished:
        r.kind = Kind::finished;
        break;
      default:
        break;
    }
    return r;
  }

  TaughtTask<N> task_;
  ExecutorSettings s_;
};

SKINCTL_END_NAMESPACE
