#include "skinctl/core/gripper.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

using namespace skinctl;

namespace {
constexpr GripperRange range{
    .opening = 0.085, .min_force = 20, .max_force = 235, .min_speed = 0.02, .max_speed = 0.15};
}

static_assert(limited(GripperGoal{0.04, 50, 0.1}, range) == GripperGoal{0.04, 50, 0.1});
static_assert(limited(GripperGoal{-1, 0, 0}, range) == GripperGoal{0, 20, 0.02});
static_assert(limited(GripperGoal{1, 1e9, 1e9}, range) == GripperGoal{0.085, 235, 0.15});

TEST_CASE("gripper: a goal needs three numbers") {
  CHECK(finite(GripperGoal{0.04, 50, 0.1}));
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL}) {
    CHECK_FALSE(finite(GripperGoal{wrong, 50, 0.1}));
    CHECK_FALSE(finite(GripperGoal{0.04, wrong, 0.1}));
    CHECK_FALSE(finite(GripperGoal{0.04, 50, wrong}));
  }
}

TEST_CASE("gripper: every error has words") {
  for (int k = 0; k <= static_cast<int>(GripperError::fault); ++k)
    CHECK(std::strlen(describe(static_cast<GripperError>(k))) > 10);
}
