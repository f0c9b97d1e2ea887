// Promise: the joints at a sample's time
// Tried: accelerations of 15 rad/s^2, states each 8 ms: 0.12 mrad between states, 0.48 mrad up to a
// period beyond the newest

#include "skinctl/sensing/joint_history.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<JointHistory<6>::Memory>);

namespace {
/// Joint i swings such that it accelerates by at most 15 rad/s^2, and does.
struct Swing {
  double rate;
  State<6> operator()(Nanoseconds t) const {
    State<6> s;
    s.time = t;
    for (std::size_t i = 0; i < 6; ++i) {
      const double phase = rate * seconds<double>(t) + double(i), size = 15 / (rate * rate);
      s.q[i] = size * std::sin(phase);
      s.dq[i] = size * rate * std::cos(phase);
    }
    return s;
  }
};
}  // namespace

TEST_CASE("JointHistory: 0.12 mrad at 15 rad/s^2 and 8 ms, at any time between states") {
  auto random = seeded(1);
  double worst = 0, beyond = 0, stale = 0;
  for (const double rate : {3.0, 5.0, 10.0}) {
    const Swing swing{rate};
    const JointHistory<6> history(8ms);
    JointHistory<6>::Memory m;
    for (Nanoseconds t{}; t < 4s; t += 8ms) {
      CHECK_FALSE(history.add(m, swing(t)).any());
      if (t < 200ms) continue;
      for (int k = 0; k < 4; ++k) {
        const Nanoseconds asked = t - nanoseconds(uniform(random, 0.0, 0.12));
        const auto at = history.at(m, asked);
        CHECK(at.known);
        CHECK(at.state.time == asked);
        const auto truth = swing(asked), newest = swing(t);
        for (std::size_t i = 0; i < 6; ++i) {
          worst = std::max(worst, std::abs(at.state.q[i] - truth.q[i]));
          stale = std::max(stale, std::abs(newest.q[i] - truth.q[i]));
          CHECK(std::abs(at.state.dq[i] - truth.dq[i]) <= rate * 15 * 8e-3 * 8e-3 / 8 * 1.001);
        }
      }
      const Nanoseconds ahead = nanoseconds(uniform(random, 0.0, 0.008));
      const auto at = history.at(m, t + ahead);
      CHECK(at.known);
      for (std::size_t i = 0; i < 6; ++i)
        beyond = std::max(beyond, std::abs(at.state.q[i] - swing(t + ahead).q[i]));
    }
  }
  MESSAGE("between: ", 1000 * worst, " mrad, beyond the newest: ", 1000 * beyond,
          ", the newest instead: ", 1000 * stale);
  CHECK(worst <= 15 * 0.008 * 0.008 / 8 * (1 + 1e-9));
  CHECK(worst >= 0.95 * 15 * 0.008 * 0.008 / 8);
  CHECK(beyond <= 15 * 0.008 * 0.008 / 2 * (1 + 1e-9));
}

TEST_CASE("JointHistory: its ends, irregular states, and what it refuses") {
  using History = JointHistory<2, double, 3>;
  const History history(10ms);
  History::Memory m;
  CHECK_FALSE(history.at(m, 0ns).known);
  CHECK_FALSE(history.add(m, {1s, {1, 2}, {0.5, -0.5}}).any());
  CHECK(history.at(m, 1s).known);
  CHECK_FALSE(history.at(m, 999ms).known);
  CHECK(history.at(m, 999ms).state.q[1] == 2);
  CHECK(history.at(m, 1010ms).state.q[0] == doctest::Approx(1.005));
  const auto late = history.at(m, 5s);  // a period at most
  CHECK_FALSE(late.known);
  CHECK(late.state.time == 1010ms);
  CHECK(late.state.q[0] == doctest::Approx(1.005));
  CHECK(history.add(m, {1s, {9, 9}, {}}) == Status(Reason::time_backwards));
  CHECK(history.add(m, {2s, {std::numeric_limits<double>::quiet_NaN(), 0}, {}}) ==
        Status(Reason::state_not_finite));
  CHECK_FALSE(history.add(m, {1100ms, {2, 2}, {}}).any());
  CHECK_FALSE(history.add(m, {1103ms, {3, 2}, {}}).any());
  CHECK(history.at(m, 1050ms).state.q[0] == 1.5);
  CHECK(history.at(m, 1101ms).state.q[0] == doctest::Approx(2 + 1 / 3.0));
  CHECK_FALSE(history.add(m, {1104ms, {4, 2}, {}}).any());  // the first one is forgotten
  CHECK_FALSE(history.at(m, 1050ms).known);
  CHECK(history.at(m, 1050ms).state.time == 1100ms);
  CHECK_THROWS_AS(History(0ns), ConfigurationError);
  CHECK_THROWS_AS(History(2s), ConfigurationError);
}
