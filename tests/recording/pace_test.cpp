#include "skinctl/recording/detail/pace.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("Pace: once in a period, from a gap's end on, and from where stamps begin anew") {
  detail::Pace pace(33ms);
  int times = 0;
  for (Nanoseconds now = 5s; now < 6s; now += 8ms) times += pace.due(now) ? 1 : 0;
  CHECK(times == 31);  // 30.3 periods, and the first
  CHECK(pace.due(60s));
  CHECK_FALSE(pace.due(60s + 32ms));
  CHECK(pace.due(60s + 40ms));
  CHECK_FALSE(pace.due(60s + 48ms));
  CHECK(pace.due(60s + 66ms));  // it keeps its places: 0, 33, 66 ms
  CHECK(pace.due(1s));
  CHECK_FALSE(pace.due(1s + 8ms));
  CHECK_FALSE(pace.due(1s));  // a repeated stamp
}
