// Promise: what a cell left unsaid below a delta does not push on after a release
// Tried: a press of 0.3 s, deltas of 0.5 N: with a patience of 8 ms off by a fine delta for one sample at
// most, 24 without

#include "skinctl/sensing/send_on_delta.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace skinctl;

TEST_CASE("SendOnDelta: what a receiver holds is right to within a delta and not old") {
  const SendOnDelta::Deltas deltas;
  const SendOnDelta rule(deltas, 100ms);
  std::mt19937_64 random(5);
  std::normal_distribution<float> step(0.0f, 0.002f);
  SendOnDelta::Memory memory;
  CellSample now, held;
  now.force = {0.3f, 0.2f, 0.1f};
  int sent = 0;
  const int measured = 50000;
  for (int k = 0; k < measured; ++k) {
    now.time += 4ms;
    const bool quiet = (k / 500) % 2;
    for (float& f : now.force)
      if (!quiet) f = std::abs(f + step(random));
    if (!quiet) now.proximity = std::abs(now.proximity + step(random));
    if (rule.send(memory, now)) held = now, ++sent;
    for (std::size_t i = 0; i < 3; ++i) REQUIRE(std::abs(held.force[i] - now.force[i]) < deltas.force);
    REQUIRE(std::abs(held.proximity - now.proximity) < deltas.proximity);
    REQUIRE(now.time - held.time < 100ms);
  }
  CHECK(sent > measured / 25);
  CHECK(sent < measured / 2);
}

TEST_CASE("SendOnDelta: the first measurement and numbers that are none are sent") {
  const SendOnDelta rule(SendOnDelta::Deltas{});
  SendOnDelta::Memory memory;
  CellSample s;
  CHECK(rule.send(memory, s));
  s.time = 4ms;
  CHECK_FALSE(rule.send(memory, s));
  s.acceleration[1] = std::numeric_limits<float>::quiet_NaN();
  s.time = 8ms;
  CHECK(rule.send(memory, s));
}

TEST_CASE("SendOnDelta: after a press and its release nothing is left unsaid for longer than its patience") {
  // Half a sine's square over 0.3 s, measured at 250 Hz; coarse deltas.
  SendOnDelta::Deltas deltas;
  deltas.force = 0.02f;
  deltas.fine = 1.0f / 1024;
  const auto push = [](int k) {
    const double s = k < 75 ? std::sin(3.14159265358979 * k / 75) : 0;
    return static_cast<float>(0.313 * s * s);
  };
  struct Seen {
    double impulse = 0;  // of what the receiver holds, less the true one
    int longest = 0;     // samples in a row for which it was off by `fine` or more
    int sent = 0;
  };
  const auto run = [&](const SendOnDelta& rule) {
    SendOnDelta::Memory memory;
    Seen seen;
    int off = 0;
    for (int k = 0; k < 500; ++k) {
      CellSample now;
      now.time = k * 4ms;
      now.force = {push(k), push(k), push(k)};
      seen.sent += rule.send(memory, now);
      const double lacks = std::abs(double(memory.last.force[0]) - double(now.force[0]));
      off = lacks >= deltas.fine ? off + 1 : 0;
      seen.longest = std::max(seen.longest, off);
      seen.impulse += 0.004 * (double(memory.last.force[0]) - double(now.force[0]));
    }
    return seen;
  };
  const Seen without = run(SendOnDelta(deltas)), with = run(SendOnDelta(deltas, 100ms, 8ms));
  CHECK(without.longest > 10);
  CHECK(with.longest <= 1);
  CHECK(std::abs(with.impulse) < 0.2 * std::abs(without.impulse));
  CHECK(with.sent <= without.sent + 12);
}

TEST_CASE("SendOnDelta: deltas that say nothing are refused") {
  SendOnDelta::Deltas deltas;
  deltas.force = 0;
  CHECK_THROWS_AS(SendOnDelta{deltas}, ConfigurationError);
  CHECK_THROWS_AS(SendOnDelta(SendOnDelta::Deltas{}, 0ns), ConfigurationError);
  CHECK_THROWS_AS(SendOnDelta(SendOnDelta::Deltas{}, 100ms, 0ns), ConfigurationError);
}
