// Promise: an arm whose tank is empty comes to rest beside a limit of jerk, too
// Tried: a UR5 by position that is led to goals and pushed by up to 60 N meanwhile, with 0.1 J and a base
// joint that takes 0.2 s to its acceleration; without it two of eight swing by 0.10 and 0.25 rad/s for ever.
// Energies that a port gives beside limits of jerk: `passivity/passivity_test.cpp`

#include <doctest/doctest.h>

#include <memory>
#include <random>

#include "bench/studies/attack/common.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/passivity/energy_tank.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr Nanoseconds delay = 12ms;
/// Slow ways to a goal have turns, too [rad/s].
constexpr double swings_from = 0.02;

struct Led {
  double swing = 0;   ///< speed between two turns of a joint, 5 s after the last push [rad/s]
  double energy = 0;  ///< least energy of the tank [J]
};

Led lead(unsigned seed) {
  std::mt19937 rng(seed);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  const auto period = nanoseconds(roll(0.5e-3, 2e-3));
  const JointJerk<6> jerk{28000., roll(68, 130), 90000., 7600., 1400., 230.};
  const auto robot = by_position(ur5::Model{},
                                 {.limits = limits_of<ur5::Description>(16.7),
                                  .period = period,
                                  .delay = delay,
                                  .virtual_damping = 7.1,
                                  .coulomb_friction = JointTorque<6>{0, 1.17, 0, 0, 0, 0}},
                                 EnergyTank<>({.start = 0.1, .max = 1}));
  auto tracking = tracking_settings(robot, jerk);
  tracking.lambda = 23.4, tracking.K_c = 0.53;
  const auto scene =
      Cycle(robot, attacks::skin(), SplineJoint<6>(tracking) + SkinJointControl{} + GravityControl{})
          .with(MaxJerk{jerk});
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto& home = attacks::home;
  SimulatedJoints<6> arm(SimulatedJoints<6>::Kind::position, seconds<double>(delay), 0.001,
                         {home[0], home[1], home[2], home[3], home[4], home[5]});
  State<6> measured{0ns, home, {}};
  const auto memory = std::make_unique<Scene::Memory>();
  scene.start(*memory, measured);
  JointPosition<6> goal;
  for (std::size_t i = 0; i < 6; ++i) goal[i] = home[i] + roll(-0.5, 0.5);
  attacks::Forces force{};
  attacks::Swings swings(1e-3);
  Led out;
  Scene::Input input;
  input.goal = {goal, 1s};
  for (Nanoseconds now = period; now < 10s; now += period) {
    arm.advance(seconds<double>(now));
    input.now = measured.time = now;
    measured.q = JointPosition<6>(arm.q()), measured.dq = JointVelocity<6>(arm.dq());
    input.measured = measured;
    if (now < 3s && roll(0, 1) < 3 * seconds<double>(period)) force[rng() % attacks::cells] = roll(0, 60);
    if (now >= 3s) force = {};
    const auto heard = attacks::samples(force, now);
    input.samples = heard;
    const auto sent = scene.step(*memory, input);
    input.goal.reset();
    SimulatedJoints<6>::Row row;
    for (std::size_t i = 0; i < 6; ++i) row[i] = sent.command.position[i];
    arm.command(seconds<double>(now), row);
    out.energy = std::min(out.energy, memory->robot.passivity.of<EnergyTank<>>().energy);
    if (now >= 8s) swings.take(sent.planned.velocity);
  }
  out.swing = swings.worst();
  return out;
}

}  // namespace

TEST_CASE("EnergyTank beside a limit of jerk: an arm in debt comes to rest") {
  for (const unsigned seed : {50u, 100u, 1u, 2u, 3u, 4u, 5u, 6u}) {
    CAPTURE(seed);
    const Led led = lead(seed);
    CHECK(led.energy < 0);  // an acceleration that jerk ends goes on with an empty tank
    CHECK(led.swing < swings_from);
  }
}

TEST_CASE("JerkLimits: joints are slowed no faster than they come to rest without turning back") {
  const JerkLimits<2> limits(JointLimits<2>(JointLimits<2>::Values{.lower = {-3., -3.},
                                                                   .upper = {3., 3.},
                                                                   .velocity = {2., 2.},
                                                                   .acceleration = {20., 20.},
                                                                   .torque = {100., 100.}}),
                             {50., 50.});
  const double h = 1e-3;
  const auto as_asked = [&](const JointVelocity<2>& u, const JointVelocity<2>& wish) {
    return limits.without_turning_back(u, wish, h) == wish;
  };
  CHECK(as_asked({0., 0.}, {0.1, -0.1}));     // whoever rests may move
  CHECK(as_asked({0.5, -0.5}, {0.6, -0.6}));  // or go on
  CHECK(as_asked({0.5, -0.5}, {0.497, -0.497}));
  JointVelocity<2> u{0.5, -0.5};
  for (int k = 0; k < 1000 && !(u == JointVelocity<2>{}); ++k) {
    const auto next = limits.without_turning_back(u, {-1., 1.}, h);
    CHECK(next[0] >= 0);
    CHECK(next[0] < u[0]);
    CHECK(next[1] == -next[0]);
    CHECK((u[0] - next[0]) / h <= std::sqrt(2 * 50 * u[0]) * (1 + 1e-12));
    u = next;
  }
  CHECK(u == JointVelocity<2>{});
}
