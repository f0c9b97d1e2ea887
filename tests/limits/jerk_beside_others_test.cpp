// Promise: an arm whose tank is empty comes to rest beside a limit of jerk, too
// Tried: a UR5 by position that is led to goals and pushed by up to 60 N meanwhile, with 0.1 J and a joint
// that takes 0.2 s to its acceleration; two of eight had swung by 0.10 and 0.25 rad/s for ever. Energies that
// a port gives beside limits of jerk: `passivity/passivity_test.cpp`
//
// Promise: a limit of jerk gives way to the end of a joint by velocity whose cycles come late
// Tried: a UR5 by velocity, 45 ms of delay, 26 of lag, one cycle in seven late by up to 4 periods, pushed
// towards ends: 24 scenes, at most 1 mrad beyond; where jerk holds 20 pass that, by up to 241. Also: study
// `attack`

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

/// Slow ways to a goal have turns, too [rad/s].
constexpr double swings_from = 0.02;
constexpr double quiet_from = 3, watched_from = 8, ends = 10;  ///< [s]

struct Led {
  double swing = 0;   ///< speed between two turns of a joint, long after the last push [rad/s]
  double beyond = 0;  ///< of a joint, beyond its ends [rad]
  Status status;
};

/// An arm that goes to `goal` and is pushed at random by up to 60 N.
template <class Scene>
Led lead(const Scene& scene, const RobotConfiguration<6>& c, SimulatedJoints<6>::Kind kind, double late,
         const JointPosition<6>& goal, std::mt19937& rng) {
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  const auto& home = attacks::home;
  SimulatedJoints<6> arm(kind, seconds<double>(c.delay), seconds<double>(c.lag),
                         {home[0], home[1], home[2], home[3], home[4], home[5]});
  State<6> measured{0ns, home, {}};
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, measured);
  attacks::Forces force{};
  attacks::Swings swings(1e-3);
  Led out;
  typename Scene::Input input;
  input.goal = {goal, 1s};
  for (double t = 0; t < ends;) {
    input.now += c.period * (roll(0, 1) < late ? 2 + int(rng() % 4) : 1);
    t = seconds<double>(input.now);
    arm.advance(t);
    measured.time = input.now;
    measured.q = JointPosition<6>(arm.q()), measured.dq = JointVelocity<6>(arm.dq());
    input.measured = measured;
    if (t < quiet_from && roll(0, 1) < 3 * seconds<double>(c.period))
      force[rng() % attacks::cells] = roll(0, 60);
    if (t >= quiet_from) force = {};
    const auto heard = attacks::samples(force, input.now);
    input.samples = heard;
    const auto sent = scene.step(*memory, input);
    input.goal.reset();
    SimulatedJoints<6>::Row row;
    for (std::size_t i = 0; i < 6; ++i) {
      row[i] =
          kind == SimulatedJoints<6>::Kind::position ? sent.planned.position[i] : sent.planned.velocity[i];
      out.beyond =
          std::max({out.beyond, measured.q[i] - c.limits.upper()[i], c.limits.lower()[i] - measured.q[i]});
    }
    arm.command(t, row);
    if (t >= watched_from) swings.take(sent.planned.velocity);
    out.status |= sent.status;
  }
  out.swing = swings.worst();
  return out;
}

}  // namespace

TEST_CASE("EnergyTank beside a limit of jerk: an arm in debt comes to rest") {
  for (const unsigned seed : {50u, 100u, 1u, 2u, 3u, 4u, 5u, 6u}) {
    CAPTURE(seed);
    std::mt19937 rng(seed);
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    const RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(16.7),
                                  .period = nanoseconds(roll(0.5e-3, 2e-3)),
                                  .delay = 12ms,
                                  .lag = 1ms,
                                  .virtual_damping = 7.1,
                                  .coulomb_friction = JointTorque<6>{0, 1.17, 0, 0, 0, 0}};
    const JointJerk<6> jerk{28000., roll(68, 130), 90000., 7600., 1400., 230.};
    JointPosition<6> goal;
    for (std::size_t i = 0; i < 6; ++i) goal[i] = attacks::home[i] + roll(-0.5, 0.5);
    const auto robot = by_position(ur5::Model{}, c, EnergyTank<>({.start = 0.1, .max = 1}));
    auto tracking = tracking_settings(robot, jerk);
    tracking.lambda = 23.4, tracking.K_c = 0.53;
    const auto scene =
        Cycle(robot, attacks::skin(), SplineJoint<6>(tracking) + SkinJointControl{} + GravityControl{})
            .with(MaxJerk{jerk});
    const Led led = lead(scene, c, SimulatedJoints<6>::Kind::position, 0, goal, rng);
    CHECK(led.status.has(Reason::tank_empty));
    CHECK(led.swing < swings_from);
  }
}

TEST_CASE("MaxJerk by velocity: late cycles lead no joint beyond its end") {
  int gave_way = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    CAPTURE(seed);
    std::mt19937 rng(seed);
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    auto limits = limits_of<ur5::Description>(15.7).values();
    for (std::size_t i = 0; i < 6; ++i)
      limits.lower[i] = attacks::home[i] - roll(0.1, 0.3),
      limits.upper[i] = attacks::home[i] + roll(0.1, 0.3);
    const RobotConfiguration<6> c{
        .limits = JointLimits<6>(limits), .period = 5500us, .delay = 45ms, .lag = 26ms, .virtual_damping = 4};
    const auto jerk = JointJerk<6>::constant(roll(60, 200));
    const auto robot = by_velocity(ur5::Model{}, c);
    const auto scene =
        Cycle(robot, attacks::skin(),
              SplineJoint<6>(tracking_settings(robot, jerk)) + SkinJointControl{} + GravityControl{})
            .with(MaxJerk{jerk});
    const Led led = lead(scene, c, SimulatedJoints<6>::Kind::velocity, 0.14, attacks::home, rng);
    CHECK(led.beyond < 1e-3);
    CHECK(led.swing < swings_from);
    gave_way += led.status.has(Reason::jerk_exceeded);
  }
  CHECK(gave_way > 0);
}

namespace {

const JerkLimits<2> two_joints(JointLimits<2>(JointLimits<2>::Values{.lower = {-3., -3.},
                                                                     .upper = {3., 3.},
                                                                     .velocity = {2., 2.},
                                                                     .acceleration = {20., 20.},
                                                                     .torque = {100., 100.}}),
                               {50., 50.});
constexpr double h = 1e-3;

}  // namespace

TEST_CASE("JerkLimits: joints are slowed no faster than they come to rest without turning back") {
  const auto as_asked = [&](const JointVelocity<2>& u, const JointVelocity<2>& wish) {
    return two_joints.without_turning_back(u, wish, h) == wish;
  };
  CHECK(as_asked({0., 0.}, {0.1, -0.1}));     // whoever rests may move
  CHECK(as_asked({0.5, -0.5}, {0.6, -0.6}));  // or go on
  CHECK(as_asked({0.5, -0.5}, {0.497, -0.497}));
  JointVelocity<2> u{0.5, -0.5};
  for (int k = 0; k < 1000 && !(u == JointVelocity<2>{}); ++k) {
    const auto next = two_joints.without_turning_back(u, {-1., 1.}, h);
    CHECK(next[0] >= 0);
    CHECK(next[0] < u[0]);
    CHECK(next[1] == -next[0]);
    CHECK((u[0] - next[0]) / h <= std::sqrt(2 * 50 * u[0]) * (1 + 1e-12));
    u = next;
  }
  CHECK(u == JointVelocity<2>{});
}

TEST_CASE("JerkLimits: jerk gives way to an end that no stop within it leaves") {
  // From 0.5 rad/s the quickest stop takes 2 sqrt(u/J) = 0.2 s and 0.05 rad.
  for (const double way : {0.06, 0.04, 0.01, 0.0}) {
    CAPTURE(way);
    JointVelocity<2> u{0.5, -0.5};
    JointAcceleration<2> a;
    JointPosition<2> q;
    bool gave_way = false;
    for (int k = 0; k < 400; ++k) {
      const JointRoom<2> wide{JointPosition<2>::constant(1), JointPosition<2>::constant(1)};
      auto motion = two_joints.brake(wide, u, a, h);
      two_joints.brake_before(motion, {{1., way + q[1]}, {way - q[0], 1.}}, u, a, h, 0);
      for (std::size_t i = 0; i < 2; ++i) {
        q[i] += motion.displacement[i];
        CHECK(std::abs(motion.velocity[i] - u[i]) <= 20 * h * (1 + 1e-12));
      }
      u = motion.velocity, a = motion.acceleration;
      gave_way = gave_way || motion.status.has(Reason::jerk_exceeded);
    }
    CHECK(u == JointVelocity<2>{});
    CHECK(gave_way == (way < 0.05));
    CHECK(q[1] == -q[0]);
    CHECK(q[0] <= std::max(way, 0.5 * 0.5 / 40) * (1 + 1e-9));
  }
}
