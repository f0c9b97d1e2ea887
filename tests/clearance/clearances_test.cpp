#include "skinctl/clearance/clearances.hpp"

#include <doctest/doctest.h>

#include "skinctl/law/law.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("Clearances: gradients are differences of distances, and joints that move both sides have none") {
  const Clearance given{.capsules = {{1, {{-0.05, 0.0, 0.13}, {-0.36, 0.0, 0.13}, 0.05}},
                                     {5, {{0.0, 0.0, 0.03}, {0.0, 0.0, 0.08}, 0.04}},
                                     {LinkCapsule::fixed, {{1.0, 0.2, 0.1}, {1.0, -0.3, 0.3}, 0.1}}},
                        .pairs = {{0, 1}, {1, 2}}};
  const Clearances<ur5::Model> clearances(ur5::Model{}, given);
  CHECK(clearances.between(0) == 0b111100);
  CHECK(clearances.between(1) == 0b111111);
  auto rng = seeded(7);
  double worst = 0;
  for (int n = 0; n < 200; ++n) {
    JointPosition<6> q;
    for (auto& x : q) x = uniform(rng, -3.0, 3.0);
    double gradient[64][6], low[64], high[64];
    clearances.gradients(q, gradient);
    for (std::size_t i = 0; i < 6; ++i) {
      auto a = q, b = q;
      a[i] -= 1e-6, b[i] += 1e-6;
      clearances.distances(a, low);
      clearances.distances(b, high);
      for (std::size_t k = 0; k < 2; ++k)
        worst = std::max(worst, std::abs((high[k] - low[k]) / 2e-6 - gradient[k][i]));
      if (i < 2) CHECK(gradient[0][i] == 0);
    }
  }
  CHECK(worst < 1e-4);
}
