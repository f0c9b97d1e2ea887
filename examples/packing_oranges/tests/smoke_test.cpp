// Two oranges, packed by two UR5: the shortest run.
#include <doctest/doctest.h>

#include "examples/packing_oranges/run.hpp"

using namespace packing;
using namespace std::chrono_literals;

TEST_CASE("packing_oranges: two oranges are judged and packed") {
  RunSettings settings;
  settings.supply.oranges = 2;
  settings.seed = 3;
  settings.touch_every = 0;
  settings.work.executor.max_place_wait = 2s;
  const Outcome o = run_ur5(settings);
  CHECK(o.over);
  CHECK(o.right() == 2);
  CHECK(o.lost() == 0);
  for (const auto& arm : o.arm)
    for (const auto& judged : arm.judged)
      CHECK(judged.stiffness == doctest::Approx(judged.truth).epsilon(0.05));
}
