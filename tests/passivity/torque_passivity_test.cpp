#include "bench/studies/worlds/torque_passivity.hpp"

#include <doctest/doctest.h>

#include "tests/support/digits.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
// Fewer where the sanitizers slow it down.
constexpr std::uint64_t scenes = SKINCTL_MANY_DIGITS ? 40 : 4;
EnergyTank<> tank(double energy, double port_gain) {
  return EnergyTank<>({.start = energy, .max = energy, .port_gain = port_gain});
}
}  // namespace

// A part of bench/studies/energy.cpp.
TEST_CASE("Resolver for torques: with a tank no contact gets more energy than it gave and the tank held") {
  constexpr double energy = 3;
  int broken = 0, empty = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    CAPTURE(seed);
    const RandomScene scene(seed);
    // All that the law does beside gravity is paid for ...
    const auto kept = run_torque(scene, Passivity(tank(energy, 0)));
    CHECK(kept.finite);
    CHECK(kept.extracted <= energy);
    CHECK(kept.debt <= 0.02 * energy);
    empty += kept.status.has(Reason::tank_empty);
    // ... or a touch is answered for nothing, and is the port with what it does at the joints: twice.
    const auto felt = run_torque(scene, Passivity(tank(energy, 1)));
    CHECK(2 * felt.extracted <= energy);
    const auto bare = run_torque(scene, Passivity(tank(1e6, 1)));
    broken += bare.extracted > energy;
    CHECK_FALSE(bare.status.has(Reason::tank_empty));
  }
  CHECK(empty > 0);
  if (scenes > 10) CHECK(broken > 0);  // so the test can fail
}
