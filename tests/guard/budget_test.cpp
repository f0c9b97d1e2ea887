#include "skinctl/guard/budget.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

static_assert(std::is_trivially_copyable_v<BudgetMemory>);

TEST_CASE("TimeBudget: refuses what cannot work") {
  CHECK_THROWS_AS(TimeBudget({.cycle = 0ns}), ConfigurationError);
  CHECK_THROWS_AS(TimeBudget({.cycle = 1ms, .skip_after = 0}), ConfigurationError);
  CHECK_THROWS_AS(TimeBudget({.cycle = 1ms, .skip_after = 4, .stop_after = 3}), ConfigurationError);
  CHECK_THROWS_AS(TimeBudget({.cycle = 1ms, .resume_work_after = 0}), ConfigurationError);
}

TEST_CASE("TimeBudget: skips optional work, stops, and lets work come back after calm") {
  const TimeBudget budget({.cycle = 1ms, .skip_after = 2, .stop_after = 4, .resume_work_after = 3});
  BudgetMemory m;
  const Status none, skip = Reason::work_skipped, stop = skip | Reason::budget_overrun;
  const auto late = [&] { return budget.step(m, 1ms + 1ns); };
  const auto fine = [&] { return budget.step(m, 1ms); };
  CHECK(fine() == none);
  CHECK(late() == none);  // one alone changes nothing
  CHECK(fine() == none);
  CHECK(late() == none);
  CHECK(late() == skip);
  CHECK(fine() == skip);
  CHECK(late() == skip);  // not in a row any more: no stop
  CHECK(late() == skip);
  CHECK(late() == skip);
  CHECK(late() == stop);
  CHECK(late() == stop);  // as long as it lasts
  CHECK(fine() == skip);
  CHECK(fine() == skip);
  CHECK(fine() == none);
  CHECK(m.overruns == 8);
}

TEST_CASE("TimeBudget: durations that cannot be are overruns or none, never worse") {
  const TimeBudget budget({.cycle = 1ms, .stop_after = 2});
  BudgetMemory m;
  CHECK_FALSE(budget.step(m, Nanoseconds::min()).any());
  CHECK(budget.step(m, Nanoseconds::max()) == Status(Reason::work_skipped));
  for (int k = 0; k < 1000; ++k) CHECK(budget.step(m, Nanoseconds::max()).has(Reason::budget_overrun));
}
