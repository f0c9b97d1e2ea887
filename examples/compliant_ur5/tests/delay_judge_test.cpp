// The judge of the way to the robot and back: what it calls longer, and what it does not.
//
// Promise: a network that becomes slower while the arm moves ends the job within 0.25 s of states, whatever
// it was at the start; single packets that come late do not
// Tried: trips of 2 to 60 ms at the start, 9 to 60 ms more; stalls of 200 ms every half second, every third
// trip late, unknown ones; the job itself over a wire that becomes slower: `faults`

#include "examples/compliant_ur5/delay_judge.hpp"

#include <doctest/doctest.h>

using compliant_ur5::DelayJudge;

namespace {

constexpr double period = 0.008, margin = 0.015, lasting = DelayJudge::beyond_time_out;

/// Cycles until it is late, of `seconds`; -1: it never is.
template <class Trip>
int late_after(DelayJudge judge, double seconds, Trip&& trip) {
  for (int k = 0; k * period < seconds; ++k) {
    judge.cycle(k * period, period, trip(k * period));
    if (judge.late()) return k;
  }
  return -1;
}

}  // namespace

TEST_CASE("Delay judge: a way that stays as it was at the start is not longer, whatever it is") {
  for (const double trip : {0.002, 0.008, 0.016, 0.03, 0.06}) {
    CAPTURE(trip);
    CHECK(late_after(DelayJudge(period, trip, margin, lasting), 60, [&](double) { return trip; }) == -1);
  }
}

TEST_CASE("Delay judge: one that becomes longer by more than the margin is, after `lasting`") {
  for (const double trip : {0.002, 0.008, 0.03})
    for (const double more : {0.009, 0.0149, 0.0151, 0.04, 0.06}) {
      CAPTURE(trip);
      CAPTURE(more);
      const int at = late_after(DelayJudge(period, trip, margin, lasting), 10,
                                [&](double t) { return t < 4 ? trip : trip + more; });
      if (more < margin) {
        CHECK(at == -1);
      } else {
        CHECK(at * period >= 4 + lasting - 2 * period);
        CHECK(at * period <= 4 + lasting + 2 * period);
      }
    }
}

TEST_CASE("Delay judge: one that is longer from the start than declared is, too") {
  CHECK(late_after(DelayJudge(period, 0, margin, lasting), 2, [](double) { return 0.06; }) > 0);
}

TEST_CASE("Delay judge: packets that TCP finds lost, late single ones and unknown ones are no longer way") {
  const auto judge = [] { return DelayJudge(period, 0, margin, lasting); };
  const auto since_half = [](double t) { return t - 0.5 * static_cast<int>(2 * t); };
  CHECK(late_after(judge(), 60,
                   [&](double t) { return since_half(t) < 0.2 ? 0.008 + since_half(t) : 0.008; }) == -1);
  CHECK(late_after(judge(), 60,
                   [](double t) { return static_cast<int>(t / period + 0.5) % 3 == 0 ? 0.1 : 0.008; }) == -1);
  CHECK(late_after(judge(), 60, [](double) { return -1.0; }) == -1);
}
