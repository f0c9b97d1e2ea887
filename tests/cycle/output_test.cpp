#include <doctest/doctest.h>

#include <memory>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

namespace {

const State<6> home{.time = 0ns, .q = {0.1, -1.2, 1.4, -1.8, -1.57, 0.3}, .dq = {}};

/// Runs a scene that is pushed, and calls `each(out)` for the outputs of its cycles.
template <class Robot, class Each>
void push(const Robot& robot, const Each& each) {
  const Cycle scene(robot, ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
  auto memory = std::make_unique<typename decltype(scene)::Memory>();
  State<6> at = home;
  scene.start(*memory, at);
  for (int k = 1; k <= 40; ++k) {
    at.time = k * 8ms;
    const CellSample sample{.time = at.time - 1ms, .cell = 60, .force = {0.3F, 0.3F, 0.3F}};
    typename decltype(scene)::Input input;
    input.now = at.time;
    input.measured = at;
    input.samples = {&sample, 1};
    const auto out = scene.step(*memory, input);
    REQUIRE(out.command.valid);
    CHECK(out.command.time == input.now);
    each(out);
  }
}
const JointLimits<6> limits = limits_of<ur5::Description>(15.0);
RobotConfiguration<6> arm() {
  return {.limits = limits, .period = 8ms, .delay = 8ms, .virtual_damping = 4};
}
template <LinkMask Set>
RobotConfiguration<3> part(bool by_torque) {
  RobotConfiguration<3> c{.limits = limits.part<JointSubset<6, Set>>(), .period = 8ms, .delay = 8ms};
  if (!by_torque) c.virtual_damping = 4;
  return c;
}
/// Counts the joints whose number differs from zero.
template <class Row>
int moved(const Row& row) {
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) count += row[i] != 0;
  return count;
}

}  // namespace

TEST_CASE("CycleOutput: the command has the planned numbers of its interface") {
  int moves = 0;
  push(by_position(ur5::Model{}, arm()), [&](const auto& out) {
    CHECK(out.command.position == out.planned.position);
    moves += moved(out.planned.velocity);
  });
  push(by_velocity(ur5::Model{}, arm()), [&](const auto& out) {
    CHECK(out.command.velocity == out.planned.velocity);
    moves += moved(out.command.velocity);
  });
  auto c = arm();
  c.virtual_damping = {};
  c.virtual_inertia = JointTorque<6>::constant(0.5);
  push(by_torque(ur5::Model{}, c, FrictionUncompensated{}), [&](const auto& out) {
    CHECK(out.command.torque == out.planned.torque);
    moves += moved(out.command.torque);
  });
  CHECK(moves > 300);  // of 360
}

TEST_CASE("CycleOutput: the devices of a robot in groups get the parts of its command") {
  const auto robot = by_groups(ur5::Model{}, velocity_joints<0b000111>(part<0b000111>(false)),
                               torque_joints<0b111000>(part<0b111000>(true)));
  using Robot = detail::ResolverFor<decltype(robot)>;
  int moves = 0;
  push(robot, [&](const auto& out) {
    const auto stiff = Robot::stiff(out.command);
    const auto torque = Robot::torque(out.command);
    static_assert(std::is_same_v<decltype(stiff), const VelocityCommand<3>>);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(stiff.velocity[i] == out.planned.velocity[i]);
      CHECK(torque[i] == out.planned.torque[i + 3]);
    }
    CHECK(stiff.valid);
    CHECK(stiff.time == out.command.time);
    moves += moved(stiff.velocity) + moved(torque);
  });
  CHECK(moves > 150);  // of 240
}
