// Promise: a clock that leaps, once or for good, stops the scene for two cycles
// Tried: 200 ms to 30 years, forth and back, with and without the skin's, every interface
//
// Promise: stamps in another unit than nanoseconds are named within 102 cycles, and stay so
// Tried: micro- and milliseconds in the place of nanoseconds, every interface; five times as many cycles as
// declared are not

#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// A scene whose clock is `clock(k)` in cycle k; cell 150 is pressed from cycle 400 on. The share of the
// cycles from `from` on in which the clock was refused, and how far joint 1 moved in the last second.
struct Seen {
  int refused = 0;
  int refused_after = 0;  ///< more than two cycles after a leap
  double yielded = 0;
  double fastest = 0;  ///< of a command [rad/s]
  Status at_end;
  int named = 0;  ///< the first cycle that was said to be too short
};
template <Interface I, class Clock>
Seen run(Clock&& clock, bool samples_leap) {
  SceneSettings s;
  if (I == Interface::torque) s.decay = 0;
  const auto scene = kinesthetic_scene<I>(s);
  StiffJoints<> robot(home_position(), s.delay, s.lag);
  State<6> state = robot.state();
  auto memory = std::make_unique<typename decltype(scene)::Memory>(scene.start(state));
  Seen seen;
  int since = 1000;
  Nanoseconds offset{};
  JointPosition<6> before;
  std::array<double, 6> begun{};
  for (int k = 1; k <= 600; ++k) {
    const Nanoseconds truth = k * s.period, now = clock(k, truth);
    since = now - truth == offset ? since + 1 : 0;
    offset = now - truth;
    if constexpr (I == Interface::position) state = robot.run_to(truth);
    state.time = now;
    const float f = k > 400 ? 0.5f : 0.0f;
    const CellSample sample{.time = samples_leap ? now : truth, .cell = 150, .force = {f, f, f}};
    typename std::remove_cvref_t<decltype(scene)>::Input input;
    input.now = now;
    input.measured = state;
    input.samples = std::span(&sample, 1);
    const auto out = scene.step(*memory, input);
    REQUIRE(out.command.valid);
    if (I == Interface::position && k > 1)
      for (std::size_t i = 0; i < 6; ++i)
        seen.fastest = std::max(seen.fastest, std::abs(out.planned.position[i] - before[i]) / 0.008);
    before = out.planned.position;
    if constexpr (I == Interface::velocity) {
      state.q = integrate(state.q, out.command.velocity, 0.008);
      state.dq = out.command.velocity;
    }
    robot.command(truth, out.planned.position);
    if (out.status.has(Reason::time_backwards)) {
      ++seen.refused;
      if (since > 2) ++seen.refused_after;
    }
    for (std::size_t i = 0; i < 6; ++i) {
      const double x = I == Interface::torque ? out.planned.torque[i] : state.q[i];
      if (k == 400) begun[i] = x;
      if (k == 600) seen.yielded += std::abs(x - begun[i]);
    }
    seen.at_end = out.status;
    if (seen.named == 0 && out.status.has(Reason::interval_too_short)) seen.named = k;
  }
  return seen;
}

template <Interface I>
void check_units() {
  for (const std::int64_t unit : {1000, 1'000'000}) {  // microseconds, milliseconds
    CAPTURE(unit);
    const auto seen = run<I>([&](int, Nanoseconds t) { return 1h + Nanoseconds(t.count() / unit); }, true);
    CHECK(seen.at_end.has(Reason::interval_too_short));
    CHECK(seen.named >= 100);
    CHECK(seen.named <= 102);
  }
  // Once the clock is right, nothing is reported any more; nor of a loop that runs faster than it says.
  const auto mended = run<I>([](int k, Nanoseconds t) { return k < 300 ? 1h + t / 1000 : 1h + t; }, true);
  CHECK_FALSE(mended.at_end.has(Reason::interval_too_short));
  CHECK_FALSE(run<I>([](int, Nanoseconds t) { return t / 5; }, true).at_end.has(Reason::interval_too_short));
}

template <Interface I>
void check_all() {
  const auto right = [](int, Nanoseconds t) { return t; };
  const double yields = run<I>(right, false).yielded;
  REQUIRE(yields > 0.05);
  for (const Nanoseconds leap :
       {Nanoseconds(1h), Nanoseconds(24h * 365 * 30), Nanoseconds(200ms), -Nanoseconds(1h)})
    for (const bool samples_leap : {false, true}) {
      CAPTURE(leap.count());
      CAPTURE(samples_leap);
      // One stamp, three stamps, from there on: it goes on, within two cycles of each change.
      for (const int cycles : {1, 3, 100000}) {
        CAPTURE(cycles);
        const auto seen = run<I>(
            [&](int k, Nanoseconds t) { return k >= 100 && k < 100 + cycles ? t + leap : t; }, samples_leap);
        CHECK(seen.refused <= 2);
        CHECK(seen.refused_after == 0);
        CHECK_FALSE(seen.at_end.has(Reason::time_backwards));
        CHECK_FALSE(seen.at_end.has(Reason::state_stale));
        if (cycles < 100 || samples_leap) CHECK(seen.yielded == doctest::Approx(yields).epsilon(0.1));
        CHECK(seen.fastest <= 3.15);
      }
    }
}

}  // namespace

TEST_CASE("cycle: one stamp far ahead, or back, does not stop the scene for good") {
  check_all<Interface::position>();
  check_all<Interface::velocity>();
  check_all<Interface::torque>();
}

TEST_CASE("cycle: stamps in another unit than nanoseconds are named") {
  check_units<Interface::position>();
  check_units<Interface::velocity>();
  check_units<Interface::torque>();
}

TEST_CASE("cycle: a next memory that is dropped is told as a cycle that came too late, and the robot stays") {
  SceneSettings s;
  const auto scene = kinesthetic_scene<Interface::position>(s);
  StiffJoints<> robot(home_position(), s.delay, s.lag);
  const auto memory = scene.start(robot.state());
  const Nanoseconds longest = 5 * s.period;  // that is integrated at once, by default
  for (int k = 1; k <= 100; ++k) {
    decltype(scene)::Input input;
    input.now = k * s.period;
    input.measured = robot.run_to(input.now);
    const CellSample push{.time = input.now, .cell = 150, .force = {1, 1, 1}};
    input.samples = {&push, 1};
    const auto [out, next] = scene(memory, input);
    CAPTURE(k);
    CHECK(out.status.has(Reason::interval_too_long) == (input.now > longest));
    if (out.command.valid) robot.command(input.now, out.command.position);
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(std::abs(out.command.position[i] - home_position()[i]) < 1e-2);  // what one interval moves
  }
}
