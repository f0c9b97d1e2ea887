#include "skinctl/tracking/redundancy.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("PostureNullSpace: goes home, no joint faster than asked, and its acceleration is a derivative") {
  Seeded rng(2);
  const JointPosition<3> home{0.1, -0.2, 0.3};
  const PostureNullSpace<3> posture(home, 2.0, 0.5);
  for (int k = 0; k < 200; ++k) {
    const auto q = rng.vector<JointPosition<3>>(k < 100 ? 3 : 0.01);
    const auto dq = rng.vector<JointVelocity<3>>(1);
    const auto m = posture.motion(q, dq);
    const auto ahead = posture.motion(integrate(q, dq, 1e-6), dq),
               behind = posture.motion(integrate(q, dq, -1e-6), dq);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(magnitude(m.v[i]) < 0.5);
      CHECK(m.v[i] * (q[i] - home[i]) <= 0);
      CHECK(magnitude((ahead.v[i] - behind.v[i]) / 2e-6 - m.a[i]) < 1e-7);
    }
  }
  CHECK(posture.motion(home, {}).v == JointVelocity<3>{});
  CHECK_THROWS_AS(PostureNullSpace<3>(home, 0.0), ConfigurationError);
  CHECK_THROWS_AS(PostureNullSpace<3>(home, 1.0, -1.0), ConfigurationError);
  const JointVelocity<3> dq{1, 2, 3};
  CHECK(FreeNullSpace().motion(home, dq).v == dq);
}
