#include "skinctl/sensing/evidence.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("Evidence: each source by its table, and within its bounds whatever it is given") {
  CHECK(proximity_evidence(0.04) == 3.9);
  CHECK(proximity_evidence(0.05) == 0);
  CHECK(proximity_evidence(0.5) == 0);
  CHECK(proximity_evidence(0.51) == -3.9);

  CHECK(median_evidence(10.0, 8.0) == 3);
  CHECK(median_evidence(10.6, 8.0) == -1);
  CHECK(median_evidence(3.0, 3.0) == -0.4);
  CHECK(median_evidence(-8.0, -8.0) == -1);  // fallen together: no touch, but nothing to release either

  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  CHECK(proximity_evidence(nan) == 0);
  for (const double x : {nan, inf, -inf, 1e300, 0.0, 5.0})
    for (const double y : {nan, inf, -inf, 1e300, 0.0, 5.0}) {
      CHECK(std::abs(median_evidence(x, y)) <= 3);
      if (x != x || y != y) CHECK(median_evidence(x, y) == 0);
    }
}

TEST_CASE("Evidence: lanes say what numbers say") {
  using L = Lane<float>;
  auto rng = seeded(3);
  for (int k = 0; k < 500; ++k) {
    float a[L::lanes], b[L::lanes];
    for (std::size_t i = 0; i < L::lanes; ++i) {
      a[i] = random_or_extreme(rng, 20.f), b[i] = random_or_extreme(rng, 20.f);
      if (k % 7 == 0) b[i] = std::numeric_limits<float>::quiet_NaN();
    }
    const L x = L::load(a), y = L::load(b);
    for (std::size_t i = 0; i < L::lanes; ++i) {
      CHECK(proximity_evidence(x)[i] == proximity_evidence(a[i]));
      CHECK(median_evidence(x, y)[i] == median_evidence(a[i], b[i]));
    }
  }
}

TEST_CASE("Evidence: the median of a large patch, and of none too small") {
  auto rng = seeded(4);
  for (const std::size_t count : {60u, 61u, 254u, 255u, 1260u}) {
    CAPTURE(count);
    std::vector<RestRow> rows(count / 16 + 2);
    const std::size_t first = 5;
    std::vector<float> all;
    for (std::size_t i = 0; i < count; ++i) {
      // A fifth of the cells is touched; the others have drifted by 12 steps.
      const float r = i % 5 == 0 ? 100 : uniform<float>(rng, 11, 13);
      rows[(first + i) / 16].above[(first + i) % 16] = r;
      all.push_back(r);
    }
    std::sort(all.begin(), all.end());
    const float median = patch_median(rows.data(), first, count);
    if (count <= 255)
      CHECK(median == all[count / 2]);
    else
      CHECK(std::abs(median - 12) < 1);
  }
  const std::vector<RestRow> rows(4);
  CHECK(patch_median(rows.data(), 0, 59) != patch_median(rows.data(), 0, 59));
}
