// Scenes of robots whose joints have several interfaces: limits of the whole robot, and configurations.
#include <doctest/doctest.h>

#include "skinctl/cycle/configurations.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "tests/support/grouped_scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("Groups: a finger by torque keeps its own limits, and has its whole torque for what it holds") {
  const Pull pull{{0, 0, 0.6}, {}, {}};
  // Free: it runs to its end, and stays below its speed.
  Run run{Cycle(robot(), pull)};
  for (int k = 0; k < 1000; ++k) run.cycle();
  CHECK(run.fastest[2] < 1.02 * 3);
  CHECK(run.plant.q()[2] < 2 + 1e-3);
  CHECK(run.plant.q()[2] > 1.9);
  CHECK(run.seen.has(Reason::velocity_limited));
  CHECK(run.seen.has(Reason::position_limited));
  CHECK(run.allocated == 0);
  // Without a governor it is too fast: so the test can fail.
  Run bare{Cycle(robot(), pull).without<MotionByTorque>()};
  for (int k = 0; k < 100; ++k) bare.cycle();
  CHECK(bare.fastest[2] > 2 * 3);
  // Held fast by a hand.
  Run grasp{Cycle(robot(), pull)};
  grasp.stuck = true;
  grasp.held = grasp.plant.q();
  for (int k = 0; k < 200; ++k) grasp.cycle();
  const double gravity = gravity_torque(Model3{}, grasp.plant.q())[2];
  CHECK(grasp.out.command.torque[2] - gravity > 0.599);
}

TEST_CASE("Groups: the tool's speed and the joints' jerk are limited, whoever moves the tool") {
  const double most = 0.25;
  const JointJerk<3> jerk = JointJerk<3>::constant(400);
  for (const Pull& pull : {Pull{{6, 0, 0}, {}, {}}, Pull{{0, 5, 0}, {}, {}}, Pull{{5, -4, 0.3}, {}, {}}}) {
    CAPTURE(pull.tau[0]);
    Run run{Cycle(robot(), pull).with(MaxToolSpeed<2>{most, {tip[0], tip[1], tip[2]}, 0.7}, MaxJerk{jerk})};
    JointVelocity<3> last;
    JointAcceleration<3> before, ends;
    double roughest = 0, end_to_end = 0;
    for (int k = 0; k < 600; ++k) {
      const auto& out = run.cycle();
      for (std::size_t i = 0; i < 2; ++i) {
        const double a = (out.command.velocity[i] - last[i]) / 2e-3;
        // The limit bounds how the acceleration changes from end to end of cycles. Mean ones change by half
        // as much again where the tool's speed has the last word, as that motion does not ramp.
        if (k > 1 && !out.status.has(Reason::jerk_exceeded))
          roughest = std::max(roughest, std::abs(a - before[i]) / 2e-3);
        if (!out.status.has(Reason::jerk_exceeded))
          end_to_end = std::max(end_to_end, std::abs(out.planned.acceleration[i] - ends[i]) / 2e-3);
        ends[i] = out.planned.acceleration[i];
        before[i] = a;
        last[i] = out.command.velocity[i];
      }
    }
    CHECK(run.tip_speed < 1.02 * most);  // the finger follows its torque with a lag of 10 ms
    CHECK(run.tip_speed > 0.9 * most);
    CHECK(roughest < 1.5 * 1.001 * 400);
    CHECK(end_to_end < 1.001 * 400);
    CHECK(run.seen.has(Reason::tool_speed_limited));
    CHECK(run.allocated == 0);
    Run bare{Cycle(robot(), pull)};
    for (int k = 0; k < 600; ++k) bare.cycle();
    CHECK(bare.tip_speed > 1.5 * most);
  }
}

TEST_CASE("Groups: Resolver, Governor and Guard send no command of a state that is no number") {
  Run run{Cycle(robot(), Pull{{0, 0, 0.1}, {}, {}})};
  const double wrong[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, 5e-324};
  for (int k = 0; k < 400; ++k) {
    run.cycle();
    decltype(run.scene)::Input input;
    input.now = run.measured.time;
    input.measured = run.measured;
    (k % 2 == 0 ? input.measured.q[static_cast<std::size_t>(k) % 3]
                : input.measured.dq[static_cast<std::size_t>(k) % 3]) = wrong[k % 5];
    input.measured.time = k % 7 == 0   ? Nanoseconds::max()
                          : k % 7 == 1 ? Nanoseconds::min()
                                       : run.measured.time;
    const auto out = run.scene.step(run.memory, input);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(std::isfinite(out.command.position[i]));
      if (i < 2) CHECK(std::abs(out.command.velocity[i]) <= 3.0001);  // the finger's is its own
      CHECK(std::abs(out.command.torque[i]) <= 150.0001);
    }
  }
}

TEST_CASE("Groups: a contact on the finger above its limit stops arm and finger, until consent") {
  const std::vector<PlacedCell<2>> cells{{1, {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0.05, 0, 0}}}};
  const Skin<Model3, double, Patch<2, 1>> skin{Patch<2, 1>(cells, {.force = 100})};
  BodyRegion region{};
  region.force = 20, region.blow = 40, region.power = 1e3, region.mass = 1, region.stiffness = 1e4,
  region.first = 500ms;
  Run run{Cycle(robot(), skin, Pull{{5, 3, 0}, {}, {}})
              .with(LinkContact<2>{.region = region, .reach = 0.1, .reaction_time = 20ms})};
  const auto touch = [&](float force, CycleRequest request = CycleRequest::none) {
    const CellSample sample{.time = run.measured.time + 1ms, .cell = 1, .force = {force, force, force}};
    decltype(run.scene)::Input input;
    input.samples = std::span(&sample, 1);
    input.request = request;
    run.cycle(input);
  };
  for (int k = 0; k < 200; ++k) touch(0);
  CHECK(std::abs(run.plant.dq()[0]) > 0.3);
  for (int k = 0; k < 100; ++k) touch(0.2f);  // 60 N
  CHECK(run.seen.has(Reason::contact_force));
  for (int k = 0; k < 300; ++k) touch(0);
  CHECK(run.out.status.has(Reason::consent_awaited));
  for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(run.plant.dq()[i]) < 1e-3);
  for (int k = 0; k < 200; ++k) touch(0, CycleRequest::resume);
  CHECK(std::abs(run.plant.dq()[0]) > 0.3);
}

TEST_CASE("Groups: the rate of what laws ask for by themselves is bounded for all joints") {
  using Track = Drive<LawRole::tracking>;
  Track law{{100, 100, 0.6}, {}, {}};
  law.after = 0.1;
  auto slow = [] {
    auto column = one(false), arm = one(false), finger = one(true);
    column.lag = 0ms;
    column.torque_rate = arm.torque_rate = finger.torque_rate = 5;
    return by_groups(Model3{}, velocity_joints<0b001>(column), position_joints<0b010>(arm),
                     torque_joints<0b100>(finger));
  };
  Run run{Cycle(slow(), law).with(GuardSettings<3>{.torque_rate = 1e5})};
  run.stuck = true;
  run.held = run.plant.q();
  JointTorque<3> last = run.memory.robot.command().torque;
  JointTorque<3> most;
  for (int k = 0; k < 120; ++k) {
    const auto& out = run.cycle();
    for (std::size_t i = 0; i < 3; ++i) {
      const double step = std::abs(out.command.torque[i] - last[i]);
      if (k > 1) most[i] = std::max(most[i], step);
      last[i] = out.command.torque[i];
    }
  }
  const JointTorque<3> bound{5 * 150 * 2e-3, 5 * 150 * 2e-3, 5 * 0.7 * 2e-3};
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(most[i] > 0.9 * bound[i]);
    CHECK(most[i] < 1.1 * bound[i]);
  }
  CHECK(run.seen.has(Reason::torque_limited));
}

TEST_CASE("Configurations: of a robot in groups, gains change without a jump of any joint") {
  const auto scene = [](double gain) {
    return Cycle(robot(), Drive<LawRole::tracking>{{}, {8 * gain, 8 * gain, 0.4 * gain}, {0.6, 0.1, 0.9}});
  };
  const Configurations both(scene(1), scene(2.5));
  using Scene = std::remove_cv_t<decltype(both)>;
  Run<Scene> run{both}, other{both};
  for (int k = 0; k < 40; ++k) run.cycle(), other.cycle();
  Scene::Input input;
  input.configuration = 1;
  for (int k = 0; k < 200; ++k) {
    const auto a = run.cycle(input), b = other.cycle();
    if (k == 0) {
      // The cycle of the change gives the command that it would have given without it.
      CHECK(std::abs(a.command.velocity[0] - b.command.velocity[0]) < 1e-9);
      CHECK(std::abs(a.command.position[1] - b.command.position[1]) < 1e-9);
      CHECK(std::abs(a.command.torque[2] - b.command.torque[2]) < 1e-3 * 0.7);
      CHECK(a.status.has(Reason::bumpless_transfer));
    }
    if (k == 199) CHECK(std::abs(a.command.velocity[0] - b.command.velocity[0]) > 1e-2);
  }
  CHECK_FALSE(run.out.status.has(Reason::bumpless_transfer));
  // While the robot is stopped its gravity must not step: refused.
  Scene::Input stop;
  stop.request = CycleRequest::stop;
  stop.configuration = 1;
  run.cycle(stop);
  input.configuration = 0;
  CHECK(run.cycle(input).status.has(Reason::configuration_refused));
}

TEST_CASE("Groups: configurations that differ in the delay of a group are refused with both numbers") {
  auto other = one(false);
  other.delay = 2ms;
  const Cycle first(robot(), Pull{});
  const Cycle second(by_groups(Model3{}, velocity_joints<0b001>([] {
                                 auto column = one(false);
                                 column.lag = 0ms;
                                 return column;
                               }()),
                               position_joints<0b010>(other), torque_joints<0b100>(one(true))),
                     Pull{});
  CHECK_THROWS_WITH_AS(Configurations(first, second),
                       "skinctl: delay: 2 ms in a configuration, 4 ms in the first one", ConfigurationError);
}
