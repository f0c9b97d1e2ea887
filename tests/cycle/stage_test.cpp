#include "skinctl/cycle/stage.hpp"

#include <doctest/doctest.h>

#include <cstring>

using namespace skinctl;

TEST_CASE("stages: each has a name, and a stopwatch tells their times apart") {
  CHECK(std::strcmp(name(Stage::sense), "sense") == 0);
  CHECK(std::strcmp(name(Stage::guard), "guard") == 0);
  CHECK(std::strcmp(name(static_cast<Stage>(200)), "unknown") == 0);
  Stopwatch watch;
  watch.begin();
  const auto until = Stopwatch::now() + 2_ms;
  while (Stopwatch::now() < until) {
  }
  watch.end(Stage::sense);
  watch.end(Stage::resolve);
  CHECK(watch[Stage::sense] >= 2_ms);
  CHECK(watch[Stage::guard] == 0);
  CHECK(watch.total() == watch[Stage::sense] + watch[Stage::resolve]);
}
