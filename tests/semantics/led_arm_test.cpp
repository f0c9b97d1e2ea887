// A sample of the study `demonstration`: people teach a UR5 on its real cycle.
#include "bench/studies/worlds/led_arm.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("Demonstration: on the real cycle exactly the goals where the arm was left, within a millimetre") {
  constexpr int people = sanitized ? 2 : 8;
  double square = 0;
  for (std::uint64_t seed = 1; seed <= people; ++seed) {
    LedArm arm(seed);
    const auto led = arm.teach();
    std::vector<Taught<>> goals;
    for (const auto& t : segment(led.samples, std::vector<Object<>>{}))
      if (t.activity == Activity::reach || t.activity == Activity::put) goals.push_back(t);
    CAPTURE(seed);
    REQUIRE(goals.size() == led.goals.size());
    for (std::size_t k = 0; k < goals.size(); ++k) {
      const double off = norm(Xyz<double>(goals[k].X_WH.origin() - led.goals[k].rested.origin()));
      CHECK(off < 0.001);
      square += off * off / static_cast<double>(3 * people);
      // The pose at the switch would be further off.
      CHECK(off < norm(Xyz<double>(led.goals[k].switched.origin() - led.goals[k].rested.origin())));
    }
  }
  CHECK(std::sqrt(square) < 0.0004);
}
