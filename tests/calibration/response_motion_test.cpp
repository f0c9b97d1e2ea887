#include "skinctl/calibration/response_motion.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

namespace {
constexpr std::array<double, 6> pose{0.1, -1.2, 1.2, -1, -1.5, 0.3};
}

TEST_CASE("Response: its motion starts and ends at rest, within its amplitude and its speed") {
  const ResponseMotion<6> motion(pose, {.amplitude = 0.1, .speed = 0.3, .duration = 12});
  auto last = motion.at(0);
  CHECK(last == pose);
  double fastest = 0, furthest = 0;
  for (double t = 0.001; t <= 12; t += 0.001) {
    const auto q = motion.at(t);
    for (std::size_t i = 0; i < 6; ++i) {
      fastest = std::max(fastest, std::abs(q[i] - last[i]) / 0.001);
      furthest = std::max(furthest, std::abs(q[i] - pose[i]));
    }
    last = q;
  }
  CHECK(last == pose);
  CHECK(fastest <= 0.3);
  CHECK(fastest > 0.15);
  CHECK(furthest <= 0.1);
  CHECK_THROWS_AS(ResponseMotion<6>(pose, {.speed = 100}), ConfigurationError);
}
