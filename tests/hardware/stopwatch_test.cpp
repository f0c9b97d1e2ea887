#include "skinctl/hardware/stopwatch.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("stopwatch: tells the times of the stages apart") {
  Stopwatch watch;
  watch.begin();
  const auto until = Stopwatch::now() + 2ms;
  while (Stopwatch::now() < until) {
  }
  watch.end(Stage::sense);
  watch.end(Stage::resolve);
  CHECK(watch[Stage::sense] >= 2ms);
  CHECK(watch[Stage::guard] == 0ns);
  CHECK(watch.total() == watch[Stage::sense] + watch[Stage::resolve]);
}
