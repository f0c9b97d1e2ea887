// Promise: no energy from nowhere, behind a delay
// Tried: `Passivity(EnergyTank, PassivityObserver)`, for torques `Passivity(EnergyTank)`: 0 of 10 000
// random scenes, half of whose obstacles are seen before they are touched, give more than they had by
// position, by velocity, by torque; 335, 393 and 2324 without; a hand at 4 mm is paid for; 100 scenes beside
// limits of jerk. Also: study `energy`
//
// Promise: an arm whose account of energy is empty gives way, and can be led on
// Tried: pushed with 20 N after each of these scenes, it moves; from an account of 0 J at least a third
// as far as with 10 J, and gives nothing. Also: `passivity/passivity_observer_test.cpp`, study `energy`

#include "skinctl/passivity/passivity.hpp"

#include <doctest/doctest.h>

#include <optional>

#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/passivity/energy_tank.hpp"
#include "tests/support/contact_scene.hpp"
#include "tests/support/digits.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_empty_v<Passivity<>>);
using Full = Passivity<EnergyTank<>, PassivityObserver<>>;
static_assert(std::is_trivially_copyable_v<
              ResolverBy<Interface::position, ur5::Model, double, CrankNicolson, 32, Full>::Memory>);

// Fewer where the sanitizers slow it down.
constexpr std::uint64_t scenes = SKINCTL_MANY_DIGITS ? 300 : 60;
// Of each integrator. The study `energy` runs 10 000 of the one that is the default.
constexpr std::uint64_t some = SKINCTL_MANY_DIGITS ? 24 : 15;

// More than any scene takes.
const EnergyTank<> plenty({.start = 1e5, .max = 1e5});
const PassivityObserver<> endless({.start = 1e5, .max = 1e5});

TEST_CASE("Passivity: a port never gives more than it got and had, whatever skills, weights and delays do") {
  int broken = 0, broken_virtual = 0, held = 0, empty = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    CAPTURE(seed);
    const RandomScene scene(seed);
    const auto bare = run<Interface::position>(scene, Passivity(plenty, endless));
    const auto passivity = scene.passivity();
    const auto kept = run<Interface::position>(scene, passivity);
    const auto alone =
        run<Interface::position>(scene, Passivity(plenty, passivity.get<PassivityObserver<>>()));
    CHECK(alone.extracted <= scene.energy);
    broken += bare.extracted > scene.energy;
    broken_virtual += bare.virtual_extracted > scene.tank;
    CHECK(kept.virtual_extracted <= scene.tank);
    CHECK(kept.extracted <= scene.energy);
    CHECK(kept.least_ledger >= 0);
    // Liveness beside energy: a hand leads it back afterwards.
    CHECK(kept.led > 0.01);
    CHECK(alone.led > 0.01);
    held += kept.status.has(Reason::energy_held);
    empty += kept.status.has(Reason::tank_empty);
  }
  CHECK(held > 0);
  if (scenes < 300) return;  // too few for one that breaks
  CHECK(broken > 0);         // so the test can fail
  CHECK(broken_virtual > 0);
  CHECK(empty > 0);
}

namespace {

struct SameJerk {
  static constexpr bool smooth = true;
  JerkLimits<6> limits;
  template <std::size_t>
  const JerkLimits<6>& motion_limit_of() const noexcept {
    return limits;
  }
};

}  // namespace

TEST_CASE("Passivity: beside limits of jerk a port gives no more than it got and had, and can be led on") {
  for (const double jerk : {50.0, 1000.0})
    for (std::uint64_t seed = 1; seed <= scenes / 6; ++seed) {
      CAPTURE(jerk);
      CAPTURE(seed);
      const RandomScene scene(seed);
      const SameJerk same{{scene.configuration.limits, JointJerk<6>::constant(jerk)}};
      const auto kept = run_by<Interface::position>(same, scene, scene.passivity());
      CHECK(kept.virtual_extracted <= scene.tank);
      CHECK(kept.extracted <= scene.energy);
      CHECK(kept.led > 0.01);
    }
}

TEST_CASE("Passivity: a full tank and passivity_observer change nothing") {
  for (const std::uint64_t seed : {5u, 6u, 7u}) {
    RandomScene scene(seed);
    scene.obstacles[0].stiffness = std::min(scene.obstacles[0].stiffness, 100.0);
    scene.obstacles.resize(1);
    const auto bare = run<Interface::position>(scene, Passivity<>());
    const auto kept = run<Interface::position>(scene, Passivity(plenty, endless));
    CHECK(kept.path == bare.path);
    CHECK(kept.largest_force == bare.largest_force);
    CHECK(kept.status == bare.status);
  }
}

namespace {

// Two soft hands that push an arm to and fro, one at a time, by `swing` [m] each; nothing else drives it.
RandomScene led_by_hands(double swing, double stiffness) {
  RandomScene scene(1);
  scene.law.skills.assign(1, {});
  scene.configuration = {.limits = limits_of<ur5::Description>(20.0), .period = 8ms, .delay = 8ms};
  scene.configuration.lag = 8ms;
  scene.configuration.virtual_damping = 4;
  scene.configuration.viscous_friction = JointTorque<6>::constant(2);
  scene.period = 8ms;
  scene.delay = 1;
  scene.lag = 0.008;
  scene.obstacles.assign(2, {});
  for (int side = 0; side < 2; ++side) {
    StiffBody& hand = scene.obstacles[std::size_t(side)];
    hand.row[0] = side == 0 ? 0.5 : -0.5;
    hand.at = 0.02;
    hand.swing = side == 0 ? swing : -swing;
    hand.pulse = 2 * M_PI;
    hand.stiffness = stiffness;
  }
  return scene;
}

}  // namespace

TEST_CASE("PassivityObserver: an arm whose account is empty gives way, and is led on, and pays for it") {
  for (const double stiffness : {150.0, 600.0}) {
    CAPTURE(stiffness);
    const auto scene = led_by_hands(0.15, stiffness);
    const auto observer = [&](double energy) {
      return Passivity(PassivityObserver<>(
          {.start = energy, .max = 10, .stiffness = 3e4, .reach = {0.6, 0.6, 0.4, 0.1, 0.1, 0}}));
    };
    const auto free = run<Interface::position>(scene, observer(10));
    const auto empty = run<Interface::position>(scene, observer(0));
    CHECK(free.path > 0.5);
    CHECK(empty.status.has(Reason::energy_held));
    CHECK(empty.path > 0.35 * free.path);
    CHECK(empty.extracted <= 1e-9);
  }
}

TEST_CASE_TEMPLATE("Passivity: with a shape at the tool and with both integrators too", Integrator,
                   CrankNicolson, SemiImplicitEuler) {
  const ToolShape<5> tool({.X_LT = {{}, {0, 0, 0.1}},
                           .mass = ToolShape<5>::diagonal({4, 4, 4, 0.1, 0.1, 0.1}),
                           .damping = ToolShape<5>::diagonal({30, 30, 30, 1, 1, 1})});
  int empty = 0;
  for (std::uint64_t seed = 1; seed <= some; ++seed) {
    CAPTURE(seed);
    const RandomScene scene(seed);
    const auto kept = run<Interface::position, Integrator>(scene, scene.passivity(), tool);
    CHECK(kept.virtual_extracted <= scene.tank);
    CHECK(kept.extracted <= scene.energy);
    CHECK(kept.led > 0.01);
    empty += kept.status.has(Reason::tank_empty);
    const auto bare = run<Interface::velocity, Integrator>(scene, scene.passivity());
    CHECK(bare.virtual_extracted <= scene.tank);
    CHECK(bare.extracted <= scene.energy);
  }
  CHECK(empty > 0);
}

// The bias of the virtual robot holds gravity; with a tank, which reads gravity, it is added as it was read.
// Counted twice, the arm sinks by 83 mrad.
TEST_CASE("Passivity: an arm whose law holds its weight rests, whether or not a tank reads gravity too") {
  const RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
  const auto moved = [](const auto& arm) {
    const Cycle scene(arm, SplineJoint<6>(arm));
    State<6> at{.time = 0ns, .q = {0.2, -1.2, 1.4, -1.8, -1.57, 0.3}, .dq = {}};
    const auto start = at.q;
    auto memory = scene.start(at);
    typename decltype(scene)::Input input;
    double most = 0;
    for (int n = 1; n <= 250; ++n) {
      input.now = at.time = n * 8ms;
      input.measured = at;
      at.q = scene.step(memory, input).command.position;
      for (std::size_t i = 0; i < 6; ++i) most = std::max(most, std::abs(at.q[i] - start[i]));
    }
    return most;
  };
  CHECK(moved(by_position(ur5::Model{}, c)) < 1e-9);
  CHECK(moved(by_position(ur5::Model{}, c, EnergyTank<>({.start = 1, .max = 2}))) < 1e-9);
}

TEST_CASE("Passivity: the tank pays for the force lead, whose port is the touch as it is") {
  // A push that grows: the lead drives the arm ahead of it, and that work is the controller's own.
  const auto left = [](std::optional<Nanoseconds> lead) {
    RobotConfiguration<6> c{
        .limits = limits_of<ur5::Description>(20.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
    c.force_lead = lead;
    using Tanked = Passivity<EnergyTank<>>;
    const ResolverBy<Interface::position, ur5::Model, double, CrankNicolson, 32, Tanked> robot(
        ur5::Model{}, c, Tanked(EnergyTank<>({.start = 50, .max = 100})));
    State<6> measured;
    measured.q = {0.1, -1.5, 1.2, -1, -1.5, 0.3};
    auto memory = robot.start(measured);
    RandomSkills law;
    law.skills = {{}};
    RandomSkills::Memory law_memory;
    TouchChange<SceneTouch>::Memory touch{};
    for (int k = 1; k <= 50; ++k) {
      measured.time = 8ms * k;
      const auto interval = robot.interval(memory, measured.time);
      SceneTouch parts[max_substeps], changes[max_substeps];
      for (unsigned j = 0; j < interval.substeps; ++j) {
        parts[j].contacts.count = 1;
        auto& contact = parts[j].contacts.list[0];
        contact.row[1] = 0.5, contact.force = 0.5 * (k - 1) + 0.125 * j;
        changes[j] = TouchChange<SceneTouch>::next(touch, parts[j]);
      }
      const auto out = robot.step(memory, law, law_memory, measured, interval,
                                  std::span<const SceneTouch>(parts, interval.substeps), AnyState{},
                                  PressedUnknown{}, std::span<const SceneTouch>(changes, interval.substeps));
      measured.q = out.command.position;
    }
    return memory.passivity.template of<EnergyTank<>>().energy;
  };
  MESSAGE("left without lead " << left(0ns) << " J, with it " << left(std::nullopt) << " J");
  CHECK(left(std::nullopt) < left(0ns) - 0.01);
}
