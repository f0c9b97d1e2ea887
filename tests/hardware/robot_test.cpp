#include "skinctl/hardware/robot.hpp"

#include <doctest/doctest.h>

#include "skinctl/cycle/no_skin.hpp"

using namespace skinctl;

namespace {
struct Complete {
  Heard wait(State<6>&) noexcept { return Heard::state; }
  bool send(const PositionCommand<6>&) noexcept { return true; }
  void stop() noexcept {}
};
struct Throws {
  Heard wait(State<6>&) { return Heard::state; }
  bool send(const PositionCommand<6>&) noexcept { return true; }
  void stop() noexcept {}
};
}  // namespace

static_assert(RobotDriver<Complete, PositionCommand<6>, 6, double>);
static_assert(!RobotDriver<Complete, PositionCommand<7>, 7, double>, "another number of joints");
static_assert(!RobotDriver<Complete, VelocityCommand<6>, 6, double>, "another interface");
static_assert(!RobotDriver<Throws, PositionCommand<6>, 6, double>, "a driver that may throw in the loop");
static_assert(SkinSource<NoSkin> && !SkinSource<Complete>);

TEST_CASE("drivers: a robot without skin has no samples") {
  NoSkin skin;
  CHECK(skin.poll().empty());
}
