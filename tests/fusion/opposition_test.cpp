// Promise: skin and tracking count as opposed by the share of a joint's largest torque: a shoulder, a
// wrist and a finger alike
// Tried: 1 % of 150, 28 and 0.7 N m

#include "skinctl/fusion/opposition.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <type_traits>

using namespace skinctl;

static_assert(std::is_trivially_copyable_v<OppositionDetector::Memory>);

namespace {
const JointTorque<3> push{3.0, 0.0, 0.0}, against{-1.0, 5.0, 0.0}, with{1.0, 5.0, 0.0}, rest{},
    weak{1.5, 0.0, 0.0}, newton{1.0, 1.0, 1.0};
}  // namespace

TEST_CASE("OppositionDetector: begins when the skin pushes hard enough, and against the tracking") {
  const OppositionDetector detector({.on = 2, .off = 1});
  const auto of = [&](const JointTorque<3>& skin, const JointTorque<3>& track) {
    return detector.detect(OppositionDetector::Memory{}, skin, track, newton, 0.002).opposition;
  };
  CHECK(of(push, against) == Opposition::lasting);
  CHECK(of(push, with) == Opposition::none);
  CHECK(of(weak, against) == Opposition::none);
  CHECK(of(rest, against) == Opposition::none);
  CHECK(of(push, rest) == Opposition::none);
}

TEST_CASE("OppositionDetector: is over 50 ms after the skin let go, within a cycle at every rate") {
  const OppositionDetector detector({.on = 2, .off = 1});
  for (const int rate : {125, 500, 1000}) {
    const double dt = 1.0 / rate;
    auto memory = detector.detect(OppositionDetector::Memory{}, push, against, newton, dt).memory;
    for (int i = 0; i < rate; ++i) {  // weak: between the thresholds it lasts, whatever the tracking does
      const auto result = detector.detect(memory, weak, i % 2 ? with : against, newton, dt);
      CHECK(result.opposition == Opposition::lasting);
      memory = result.memory;
    }
    int cycles = 0;
    for (;; ++cycles) {
      const auto result = detector.detect(memory, rest, against, newton, dt);
      memory = result.memory;
      if (result.opposition != Opposition::lasting) {
        CHECK(result.opposition == Opposition::released);
        break;
      }
      REQUIRE(cycles < 1000);
    }
    CAPTURE(rate);
    CHECK(cycles * dt >= 0.05 - 1e-12);
    CHECK(cycles * dt < 0.05 + dt);
    CHECK(detector.detect(memory, rest, against, newton, dt).opposition == Opposition::none);
  }
}

TEST_CASE("OppositionDetector: a touch within the 50 ms starts them again") {
  const OppositionDetector detector({.on = 2, .off = 1});
  auto memory = detector.detect(OppositionDetector::Memory{}, push, against, newton, 0.002).memory;
  for (int i = 0; i < 20; ++i) memory = detector.detect(memory, rest, against, newton, 0.002).memory;
  memory = detector.detect(memory, weak, against, newton, 0.002).memory;
  for (int i = 0; i < 25; ++i) {
    const auto result = detector.detect(memory, rest, against, newton, 0.002);
    CHECK(result.opposition == Opposition::lasting);
    memory = result.memory;
  }
  CHECK(detector.detect(memory, rest, against, newton, 0.002).opposition == Opposition::released);
}

// A hundredth of its torque opposes a shoulder of 150 N m, a wrist of 28 and a finger's joint of 0.7 alike.
TEST_CASE("OppositionDetector: every joint counts by its own largest torque") {
  const OppositionDetector detector;
  const JointTorque<3> limits{150, 28, 0.7};
  const auto opposed = [&](const JointTorque<3>& skin, const JointTorque<3>& track) {
    return detector.detect(OppositionDetector::Memory{}, skin, track, limits, 0.002).opposition ==
           Opposition::lasting;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    JointTorque<3> skin, track;
    skin[i] = 0.011 * limits[i], track[i] = -0.02 * limits[i];
    CHECK(opposed(skin, track));
    CHECK_FALSE(opposed(skin, JointTorque<3>{} - track));
    skin[i] = 0.009 * limits[i];
    CHECK_FALSE(opposed(skin, track));
  }
  // A shoulder that moves with the push does not hide a finger that is pushed back.
  CHECK(opposed({0.1, 0, 0.1}, {1.0, 0, -0.5}));
}

TEST_CASE("OppositionDetector: torques that are not finite neither begin nor end it") {
  const OppositionDetector detector;
  const JointTorque<3> bad{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};
  CHECK(detector.detect(OppositionDetector::Memory{}, bad, against, newton, 0.002).opposition ==
        Opposition::none);
  auto memory = detector.detect(OppositionDetector::Memory{}, push, against, newton, 0.002).memory;
  for (int i = 0; i < 100; ++i) {
    const auto result = detector.detect(memory, bad, bad, newton, 0.002);
    CHECK(result.opposition == Opposition::lasting);
    memory = result.memory;
  }
}

TEST_CASE("OppositionDetector: refuses thresholds that contradict each other") {
  CHECK_THROWS_AS(OppositionDetector({.on = 1, .off = 2}), ConfigurationError);
  CHECK_THROWS_AS(OppositionDetector({.on = 1, .off = 0}), ConfigurationError);
  CHECK_THROWS_AS(OppositionDetector({.on = std::numeric_limits<double>::quiet_NaN(), .off = 1}),
                  ConfigurationError);
  CHECK_THROWS_AS(OppositionDetector({.on = 2, .off = 1, .release_after = -1ns}), ConfigurationError);
}
