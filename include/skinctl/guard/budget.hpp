// SPDX-License-Identifier: BSD-3-Clause
// A budget of time for a cycle, and the reaction to overruns.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of a `TimeBudget`.
struct BudgetSettings {
  Nanoseconds cycle;        ///< largest time from the receipt of a state until all work is done
  unsigned skip_after = 1;  ///< overruns in a row after which optional work is left out
  unsigned stop_after = 5;  ///< overruns in a row after which the guard stops until the user's consent
  unsigned resume_work_after = 100;  ///< cycles within the budget in a row after which optional work resumes
};

/// The memory of a budget. Trivially copyable.
struct BudgetMemory {
  unsigned overruns_in_a_row = 0;  ///< overruns in a row
  unsigned cycles_within = 0;      ///< cycles within the budget since the last overrun
  bool skips_work = false;         ///< optional work is left out
  std::uint64_t overruns = 0;      ///< number of all overruns
};

/// A budget of time for a cycle. It reads no clock: from the duration of a cycle it computes the status for
/// the next one (`Input::observed`), so that a recording replays its actions too.
///
/// - A single overrun changes nothing: the next cycle integrates the longer interval.
/// - `skip_after` in a row: `work_skipped`. Optional work (logs, pictures, plans) reads `input.observed` and
///   is left out, until `resume_work_after` cycles in a row were within the budget.
/// - `stop_after` in a row: `budget_overrun`, at each further overrun. The guard stops and waits for the
///   user's consent.
class TimeBudget {
 public:
  using Memory = BudgetMemory;

  /// Throws `ConfigurationError` for a number out of its range.
  explicit TimeBudget(const BudgetSettings& s) : settings_(s) {
    require(s.cycle > 0ns && s.cycle <= 10s, "TimeBudget: cycle", milliseconds(s.cycle), "> 0, <= 10 000 ms");
    require(s.skip_after >= 1, "TimeBudget: skip after", s.skip_after, ">= 1 overrun");
    require(s.stop_after >= s.skip_after, "TimeBudget: stop after", s.stop_after, ">= skip after");
    require(s.resume_work_after >= 1, "TimeBudget: calm after", s.resume_work_after, ">= 1 cycle");
  }

  /// The status for the next cycle after one that took `duration`.
  [[nodiscard]] Status step(Memory& m, Nanoseconds duration) const noexcept {
    Status out;
    if (duration > settings_.cycle) {
      ++m.overruns;
      if (m.overruns_in_a_row < settings_.stop_after) ++m.overruns_in_a_row;
      m.cycles_within = 0;
      m.skips_work = m.skips_work || m.overruns_in_a_row >= settings_.skip_after;
      if (m.overruns_in_a_row >= settings_.stop_after) out |= Reason::budget_overrun;
    } else {
      m.overruns_in_a_row = 0;
      if (m.cycles_within < settings_.resume_work_after) ++m.cycles_within;
      m.skips_work = m.skips_work && m.cycles_within < settings_.resume_work_after;
    }
    if (m.skips_work) out |= Reason::work_skipped;
    return out;
  }

  [[nodiscard]] const BudgetSettings& settings() const noexcept { return settings_; }

 private:
  BudgetSettings settings_;
};

SKINCTL_END_NAMESPACE
