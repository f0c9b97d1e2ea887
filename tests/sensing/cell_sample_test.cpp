#include "skinctl/sensing/cell_sample.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

using namespace skinctl;

namespace {

/// The eight numbers of a sample, in order: four readings, four others.
float& number(CellSample& s, std::size_t k) {
  if (k < 3) return s.force[k];
  if (k == 3) return s.proximity;
  return k < 7 ? s.acceleration[k - 4] : s.temperature;
}

CellSample good() {
  CellSample s;
  s.force = {0.25f, 1.0f, 0.0f};
  s.proximity = 0.5f;
  s.acceleration = {1.0f, -2.0f, 9.81f};
  s.temperature = -3.5f;
  return s;
}

}  // namespace

TEST_CASE("CellSample: one damaged number condemns the sample, and the status says how") {
  CHECK_FALSE(check(good()).any());
  CHECK_FALSE(check(CellSample{}).any());
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t k = 0; k < 8; ++k) {
    CAPTURE(k);
    for (const float bad : {nan, -nan, inf, -inf, std::bit_cast<float>(0x7f800001u)}) {
      CellSample s = good();
      number(s, k) = bad;
      CHECK(check(s) == Status(Reason::sample_not_finite));
    }
    for (const float edge : {-0.0f, 1.0f, std::numeric_limits<float>::denorm_min()}) {
      CellSample s = good();
      number(s, k) = edge;
      CHECK_FALSE(check(s).any());
    }
    for (const float beyond :
         {-1e-30f, std::nextafter(1.0f, 2.0f), -1e30f, std::numeric_limits<float>::max()}) {
      CellSample s = good();
      number(s, k) = beyond;
      CHECK(check(s) == (k < 4 ? Status(Reason::sample_out_of_range) : Status()));
    }
  }
}

TEST_CASE("CellSample: over random bits the check is the definition") {
  std::mt19937_64 random(1);
  int refused = 0;
  for (int n = 0; n < 300000; ++n) {
    CellSample s = good();
    for (std::size_t k = 0; k < 8; ++k)
      if (random() % 4 == 0) number(s, k) = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    bool finite = true, in_range = true;
    for (std::size_t k = 0; k < 8; ++k) {
      const float x = number(s, k);
      finite = finite && std::isfinite(x);
      if (k < 4) in_range = in_range && 0 <= x && x <= 1;
    }
    const Status expected = !finite    ? Status(Reason::sample_not_finite)
                            : in_range ? Status()
                                       : Status(Reason::sample_out_of_range);
    REQUIRE(check(s) == expected);
    refused += expected.any();
  }
  CHECK(refused > 100000);
}

TEST_CASE("CellSample: counts are the nearest, exact for sensors of 1024 steps, and never overflow") {
  CellSample s;
  for (int a = 0; a <= 1024; a += 7)
    for (int b = 0; b <= 1024; b += 31) {
      s.force = {float(a) / 1024, float(b) / 1024, float(1024 - a) / 1024};
      s.proximity = float(a * 64 + b % 64) / 65536;
      if (s.proximity > 1) s.proximity = 1;
      const CellCounts c = counts(s);
      CHECK(c.force == 16 * (b + 1024));
      CHECK(c.proximity == std::min(65535, a * 64 + b % 64));
    }
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> reading(0.0f, 1.0f);
  for (int n = 0; n < 100000; ++n) {
    s.force = {reading(random), reading(random), reading(random)};
    s.proximity = reading(random);
    const CellCounts c = counts(s);
    const double sum = double(s.force[0]) + double(s.force[1]) + double(s.force[2]);
    CHECK(std::abs(c.force * CellCounts::force_unit - sum) <= 0.51 * CellCounts::force_unit);
    CHECK(std::abs(c.proximity * CellCounts::proximity_unit - double(s.proximity)) <=
          1.01 * CellCounts::proximity_unit);
  }
  s.force = {1.0f, 1.0f, 1.0f};
  s.proximity = 1.0f;
  CHECK(counts(s) == CellCounts{49152, 65535});
  s.force = {-0.0f, -0.0f, -0.0f};
  s.proximity = -0.0f;
  CHECK(counts(s) == CellCounts{});
}
