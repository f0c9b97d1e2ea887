#include "skinctl/resolver/memory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <span>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model, double, SemiImplicitEuler>;
using Memory = VirtualJointsMemory<6, double, 32>;
template <std::size_t N, class T, std::size_t History>
using MemoryOf =
    ResolverMemory<N, T, JointGroups<N, JointGroup<Interface::position, joints_between(0, N), T>>, History>;
static_assert(std::is_trivially_copyable_v<Robot::Memory>);
static_assert(std::is_trivially_copyable_v<Memory> && std::is_trivially_copyable_v<MemoryOf<22, float, 64>>);
static_assert(sizeof(MemoryOf<6, double, 32>) <=
                  sizeof(Memory) + sizeof(detail::OwnTorque<6, double>) + 4 * sizeof(Nanoseconds),
              "state and command of a robot that is one group are held once");

TEST_CASE("ResolverMemory: a fresh one has not been started, and gives no command that may be sent") {
  const Robot robot(ur5::Model{},
                    {.limits = limits_of<ur5::Description>(), .period = 8ms, .virtual_damping = 4});
  Robot::Memory fresh{};
  CHECK_FALSE(fresh.started);
  CHECK_FALSE(fresh.group().brakes);
  GravityControl::Memory law{};
  State<6> state;
  const NoTouch nobody[1]{};
  for (Nanoseconds now = 8ms; now < 100ms; now += 8ms) {
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
  CHECK(started.command().valid);
  CHECK(started.command().position == state.q);
}

TEST_CASE("ResolverMemory: a copy by its bytes goes on as the original does") {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(40.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
  const detail::VirtualJoints<Interface::velocity, 6, double, 32> joints(c);
  Memory a = joints.start({0ns, {0.1, -1.5, 1.2, -1, -1.5, 0.3}, {}}), b;
  const auto cycle = [&](Memory& m, Nanoseconds now) {
    const Interval interval{now - 8ms, now, 1, {}};
    const auto begun = joints.begin(m, {now, m.under_way.reached, {}}, interval);
    static_cast<void>(joints.take(
        m, begun, joints.plan(m, begun, JointVelocity<6>::constant(0.2), 0.008, Abrupt{}), 0.008));
    m.time = now;
    static_cast<void>(joints.end(m, begun, {}, false));
    return m.command.velocity;
  };
  for (Nanoseconds now = 8ms; now < 400ms; now += 8ms) cycle(a, now);
  std::memcpy(static_cast<void*>(&b), &a, sizeof a);
  for (Nanoseconds now = 400ms; now < 800ms; now += 8ms) {
    const auto one = cycle(a, now), other = cycle(b, now);
    CHECK(one == other);
  }
  CHECK(a.command.velocity[0] == doctest::Approx(0.2).epsilon(0.01));
  CHECK(a.q.value == b.q.value);
}
