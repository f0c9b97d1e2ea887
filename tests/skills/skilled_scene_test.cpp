#include "bench/studies/worlds/skilled_scene.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <type_traits>

#include "skinctl/recording/recording.hpp"
#include "skinctl/testing/allocation_guard.hpp"

using namespace skinctl;
using namespace skinctl::testing;

// A part of bench/studies/nightly.cpp, which takes a day.
TEST_CASE(
    "Skills in a cycle: minutes at 1 kHz in float, recorded, replayed bit for bit, and at rest without "
    "drift") {
  static const auto scene = skilled_scene<float>(1ms);
  using Scene = std::remove_const_t<decltype(scene)>;
  static_assert(std::is_trivially_copyable_v<Scene::Memory>);
  SkilledDay<Scene> day(scene, 1ms, 5);
  Recording<Scene> recording(std::size_t(48) << 20);
  recording.start(day.measured());
  std::uint64_t allocated = 0;
  double integrals = 0, drift = 0;
  int bad = 0, changes = 0;
  std::uint8_t skill = 0;
  JointPosition<6, float> rest;
  const int busy = sanitized ? 2'000 : 60'000, home = sanitized ? 8'000 : 20'000,
            end = home + (sanitized ? 2'000 : 10'000);
  for (int k = 0; k < busy + end; ++k) {
    if (k < busy) day.happen();
    if (k == busy) day.release_all(), day.go_home();
    const AllocationGuard guard;
    const auto out = day.step();
    allocated += guard.count();
    if (k < (sanitized ? 5'000 : 20'000)) recording.add(day.last(), out.planned);
    integrals = std::max(integrals, day.integrals());
    bad += !out.command.valid;
    changes += day.memory().law.skill != skill;
    skill = day.memory().law.skill;
    for (std::size_t i = 0; i < 6; ++i) {
      bad += !std::isfinite(out.command.position[i]);
      if (k == busy + home) rest = out.command.position;
      if (k > busy + home)
        drift = std::max(drift, static_cast<double>(std::abs(out.command.position[i] - rest[i])));
    }
  }
  CHECK(bad == 0);
  CHECK(allocated == 0);
  CHECK(changes >= (sanitized ? 1 : 10));
  CHECK(integrals <= 1.001);
  CHECK(drift <= 1e-6);
  REQUIRE_FALSE(recording.full());
  CHECK(replay(scene, recording).different == 0);
}
