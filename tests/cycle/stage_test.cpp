#include "skinctl/cycle/stage.hpp"

#include <doctest/doctest.h>

#include <cstring>

using namespace skinctl;

TEST_CASE("stages: each has a name") {
  CHECK(std::strcmp(name(CycleStage::sense), "sense") == 0);
  CHECK(std::strcmp(name(CycleStage::guard), "guard") == 0);
  CHECK(std::strcmp(name(static_cast<CycleStage>(200)), "unknown") == 0);
}
