#include "skinctl/limits/skin_watch.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <type_traits>

#include "tests/support/scene.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Limits = CoverageLimits<6>;
static_assert(std::is_trivially_copyable_v<Limits::Memory>);

Coverage of(std::size_t usable, double least) {
  return {usable, 100, least};
}
std::string refusal(const SkinWatch& watch) {
  return complaint_of([&] { static_cast<void>(Limits(ur5_test_limits(), watch)); });
}
}  // namespace

TEST_CASE("Coverage: the worst patch counts") {
  Coverage c;
  c.add(10, 10);
  CHECK(c.least == 1);
  c.add(1, 4);
  c.add(3, 4);
  CHECK(c == Coverage{14, 18, 0.25});
}

TEST_CASE("CoverageLimits: states, reasons and the way back") {
  const Limits limits(ur5_test_limits(), {.enough = 0.75, .settle = 20ms});
  Limits::Memory m;
  const auto look = [&](const Coverage& c) { return limits.look(m, c, 0.008); };
  const Status unheard = Status(Reason::skin_unheard) | Reason::skin_held;
  CHECK(look(of(0, 0)) == unheard);
  CHECK(look(of(99, 0.74)) == unheard);
  CHECK(limits.stays(m));
  CHECK(look(of(90, 0.75)) == (Status(Reason::skin_incomplete) | Reason::skin_held));  // 20 ms from here
  CHECK(look(of(100, 1)) == Status(Reason::skin_held));
  CHECK(limits.stays(m));
  CHECK(look(of(100, 1)) == Status());
  CHECK_FALSE(limits.stays(m));
  CHECK(look(of(99, 0.9)) == Status(Reason::skin_incomplete));
  CHECK_FALSE(limits.stays(m));
  const Status blind = Status(Reason::skin_blind) | Reason::skin_stopped;
  CHECK(look(of(90, 0.7)) == blind);
  CHECK(limits.stays(m));
  CHECK(look(of(0, 0)) == blind);
  CHECK(look(of(100, 1)) == Status(Reason::skin_stopped));
  look(of(100, 1));
  CHECK(look(of(100, 1)) == Status());
}

TEST_CASE("CoverageLimits: a skin with a hole is blind however many of its cells report") {
  const Limits limits(ur5_test_limits(), {.settle = 0ns});
  Limits::Memory m;
  Coverage holed = of(99, 0.98);
  holed.hole = 17;
  CHECK(limits.look(m, holed, 0.008) == (Status(Reason::skin_unheard) | Reason::skin_held));
  CHECK(limits.look(m, of(99, 0.98), 0.008) == Status(Reason::skin_incomplete));
  CHECK(limits.look(m, holed, 0.008) == (Status(Reason::skin_blind) | Reason::skin_stopped));
  CHECK(limits.stays(m));
}

TEST_CASE("CoverageLimits: slowed by and by, to the stated speed, and back") {
  const auto joints = ur5_test_limits();
  const double fastest = joints.velocity()[0];
  const Limits limits(joints, {.incomplete = SkinReaction::slow_down, .slow = 0.1, .settle = 0ns});
  Limits::Memory m;
  limits.look(m, of(100, 1), 0.008);
  auto u = JointVelocity<6>::constant(fastest);
  u[2] = -fastest;
  CHECK(limits.share(m, u) == 1);
  double last = 1;
  for (int k = 0; k < 32; ++k) {
    CHECK(limits.look(m, of(99, 0.95), 0.008).has(Reason::skin_slowed));
    const double share = limits.share(m, u);
    CHECK(share < last);
    CHECK(last - share <= 0.008 / Limits::ramp + 1e-12);
    last = share;
  }
  CHECK(last * fastest == doctest::Approx(0.1));
  CHECK(limits.share(m, JointVelocity<6>::constant(0.1)) == 1);
  CHECK(limits.share(m, JointVelocity<6>::constant(std::numeric_limits<double>::quiet_NaN())) == 1);
  for (int k = 0; k < 32; ++k) limits.look(m, of(100, 1), 0.008);
  CHECK(limits.share(m, u) == 1);
}

TEST_CASE("CoverageLimits: numbers out of range are refused with the range") {
  CHECK(refusal({}).empty());
  CHECK(refusal({.enough = 0}) == "skinctl: SkinWatch: enough = 0, allowed: > 0, <= 1");
  CHECK(refusal({.enough = std::numeric_limits<double>::quiet_NaN()}).find("enough") != std::string::npos);
  CHECK(refusal({.slow = 0}).find("slow = 0") != std::string::npos);
  CHECK(refusal({.slow = 7}).find("slow = 7") != std::string::npos);
  CHECK(refusal({.settle = -1ms}).find("settle = -1") != std::string::npos);
  CHECK(refusal({.blind = static_cast<SkinReaction>(9)}).find("reaction = 9") != std::string::npos);
}
