#include "skinctl/hardware/histogram.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;

TEST_CASE("histogram: percentiles are those of the sorted durations, to 1/32") {
  oracle::Random random(1);
  Histogram histogram;
  std::vector<Nanoseconds> all;
  for (int k = 0; k < 100000; ++k) {
    const auto d = Nanoseconds(static_cast<std::int64_t>(std::exp(random.uniform(0, 25))));
    all.push_back(d);
    histogram.record(d);
  }
  std::sort(all.begin(), all.end());
  for (double p : {0.01, 0.5, 0.9, 0.99, 0.999, 0.99999}) {
    const auto exact = static_cast<double>(all[static_cast<std::size_t>(std::ceil(p * 100000)) - 1].count());
    const auto got = static_cast<double>(histogram.percentile(p).count());
    CAPTURE(p);
    CHECK(got >= exact);
    CHECK(got <= exact * (1 + 1. / 32) + 1);
  }
  CHECK(histogram.max() == all.back());
  CHECK(histogram.percentile(1) == all.back());
  CHECK(histogram.count() == 100000);
}

TEST_CASE("histogram: small durations are exact, extremes stay in range, nothing is allocated") {
  Histogram histogram;
  CHECK(histogram.percentile(0.5) == 0ns);
  const testing::AllocationGuard guard;
  for (Nanoseconds d{}; d < 32ns; ++d) histogram.record(d);
  CHECK(histogram.percentile(0.5) == 15ns);
  histogram.record(-5ns);
  histogram.record(Nanoseconds::max());
  histogram.record(Nanoseconds::min());
  CHECK(guard.count() == 0);
  CHECK(histogram.max() == Nanoseconds::max());
  CHECK(histogram.percentile(1) > 1'000s);
}

TEST_CASE("histogram: merged it counts what both did") {
  Histogram a, b;
  a.record(10ns);
  b.record(1000ns);
  b.record(20ns);
  a.merge(b);
  CHECK(a.count() == 3);
  CHECK(a.max() == 1000ns);
  CHECK(a.percentile(0.34) == 20ns);
  CHECK(a.mean() == doctest::Approx(1030. / 3));
  std::uint64_t seen = 0;
  a.for_each([&](Nanoseconds, std::uint64_t n) { seen += n; });
  CHECK(seen == 3);
}
