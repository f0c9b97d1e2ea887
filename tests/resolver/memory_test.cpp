#include "skinctl/resolver/memory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <span>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/resolver/resolver.hpp"

using namespace skinctl;

using Robot = Resolver<Interface::position, ur5::Model, double, SemiImplicitEuler>;
static_assert(std::is_trivially_copyable_v<Robot::Memory>);
static_assert(std::is_trivially_copyable_v<Resolver<Interface::velocity, ur5::Model, float>::Memory>);

TEST_CASE("ResolverMemory: a fresh one has not been started, and gives no command that may be sent") {
  const Robot robot(ur5::Model{}, {.limits = limits_of<ur5::Description>(), .period = 8_ms});
  Robot::Memory fresh{};
  CHECK_FALSE(fresh.started);
  CHECK(fresh.mode == Mode::following);
  GravityControl::Memory law{};
  State<6> state;
  const NoTouch nobody[1]{};
  for (Nanoseconds now = 8_ms; now < 100_ms; now += 8_ms) {
    state.time = now;
    const auto out = robot.step(fresh, GravityControl{}, law, state, robot.interval(fresh, now),
                                std::span<const NoTouch>(nobody));
    CHECK_FALSE(out.command.valid);
    CHECK(out.status.has(Reason::interval_empty));
  }
  state.q[2] = std::nan("");
  CHECK_FALSE(robot.start(state).started);  // and so does one that starts at no good state
  state.q[2] = 0.5;
  const auto started = robot.start(state);
  CHECK(started.started);
  CHECK(started.command.valid);
  CHECK(started.command.position == state.q);
}
