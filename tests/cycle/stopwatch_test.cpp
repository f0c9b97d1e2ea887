#include "skinctl/cycle/stopwatch.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("stopwatch: tells the times of the stages apart") {
  Stopwatch watch;
  watch.begin();
  const auto until = Stopwatch::now() + 2ms;
  while (Stopwatch::now() < until) {
  }
  watch.end(CycleStage::sense);
  watch.end(CycleStage::resolve);
  CHECK(watch[CycleStage::sense] >= 2ms);
  CHECK(watch[CycleStage::guard] == 0ns);
  CHECK(watch.total() == watch[CycleStage::sense] + watch[CycleStage::resolve]);
}
