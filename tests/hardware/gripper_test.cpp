#include "skinctl/hardware/gripper.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

namespace {
struct Complete {
  GripperRange range() const noexcept { return {.opening = 0.1, .max_force = 40, .max_speed = 0.2}; }
  bool move(const GripperGoal&) noexcept { return true; }
  GripperState poll(Nanoseconds) noexcept { return {}; }
  void stop() noexcept {}
};
struct MayThrow : Complete {
  GripperState poll(Nanoseconds) { return {}; }
};
struct Binary {
  void open() noexcept {}
  void close() noexcept {}
};
}  // namespace

static_assert(GripperDriver<Complete>);
static_assert(!GripperDriver<MayThrow>, "a driver that may throw in the loop");
static_assert(!GripperDriver<Binary>, "nobody hears how it went");

TEST_CASE("gripper: goals to open and to close") {
  const GripperRange range = Complete{}.range();
  CHECK(open_goal(range) == GripperGoal{0.1, 40, 0.2});
  CHECK(close_goal(range, 15) == GripperGoal{0, 15, 0.2});
}
