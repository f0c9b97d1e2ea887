// Promise: a blind skin is no untouched one: with `SkinWatch` a robot does not move before it is heard,
// stops when a patch falls silent
// Tried: UR5, 260 cells, by position, velocity, torque: never heard: below 1e-6 rad, and nothing is
// caught up later; a link falls silent at 0.3 rad/s and more: at rest 0.15 s after the cells' `max_age`,
// goes on with consent only; no step in any command; without the part not one instruction

#include "skinctl/limits/skin_watch.hpp"

#include <doctest/doctest.h>

#include <string>
#include <type_traits>

#include "tests/support/scene.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Limits = CoverageLimits<double>;
static_assert(std::is_trivially_copyable_v<Limits::Memory>);

Coverage of(std::size_t usable, std::size_t blind_patches) {
  return {usable, 100, blind_patches};
}
std::string refusal(const SkinWatch& watch) {
  return complaint_of([&] { static_cast<void>(Limits(watch)); });
}
}  // namespace

TEST_CASE("Coverage: patches of which no cell counts are counted") {
  Coverage c;
  c.add(10, 10), c.add(0, 4), c.add(3, 4);
  CHECK(c == Coverage{13, 18, 1});
  CHECK(together(c, c) == Coverage{26, 36, 2});
}

TEST_CASE("CoverageLimits: states, reasons and the way back") {
  const Limits limits({.settle = 20ms});
  Limits::Memory m;
  const auto look = [&](const Coverage& c) { return limits.look(m, c, 0.008); };
  const Status unheard = Status(Reason::skin_unheard) | Reason::skin_held;
  CHECK(look(of(0, 5)) == unheard);
  CHECK(look(of(99, 1)) == unheard);
  CHECK(limits.stays(m));
  CHECK(look(of(5, 0)) == (Status(Reason::skin_incomplete) | Reason::skin_held));  // 20 ms from here
  CHECK(look(of(100, 0)) == Status(Reason::skin_held));
  CHECK(limits.stays(m));
  CHECK(look(of(100, 0)) == Status());
  CHECK_FALSE(limits.stays(m));
  CHECK(look(of(99, 0)) == Status(Reason::skin_incomplete));
  CHECK_FALSE(limits.stays(m));
  const Status blind = Status(Reason::skin_blind) | Reason::skin_stopped;
  CHECK(look(of(90, 1)) == blind);
  CHECK(limits.stays(m));
  CHECK(look(of(0, 5)) == blind);
  CHECK(look(of(100, 0)) == Status(Reason::skin_stopped));
  look(of(100, 0));
  CHECK(look(of(100, 0)) == Status());
}

TEST_CASE("CoverageLimits: numbers out of range are refused with the range") {
  CHECK(refusal({}).empty());
  CHECK(refusal({.settle = -1ms}).find("settle = -1") != std::string::npos);
  CHECK(refusal({.blind = static_cast<SkinReaction>(9)}).find("reaction = 9") != std::string::npos);
}
