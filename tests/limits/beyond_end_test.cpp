// Promise: a robot by torque holds a joint that is beyond its end against what pushes it on, and lets it go
// back inside freely
// Tried: UR5 that starts up to 50 mrad beyond three ends, 1 to 8 ms, delay 0 to 20 ms, dry friction of 0 to 3
// N m that nobody declared: 8 N m or 1 kg move it by 10 to 110 mrad, as stiffly as its delay allows, and no
// further, where they moved it on for as long as they pushed. Noise does not move it. A hand and a law move
// it inside, a hand as if there were no end. Led on by 60 N m it stays where it is let go, or comes back by
// what its spring gave. Also: `bench/studies/attack_torque`

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/torque_loop.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t pushed_joint = 1;
constexpr double rotors = 0.1;  ///< at each joint [kg m^2]
constexpr double viscous =
    3;  ///< friction added to each joint, for motions in which no end is near [N m s/rad]

/// What happens to an arm that starts `outside` [rad] beyond ends of joints 0 to 2.
struct Case {
  Loop loop;
  double outside = 0.01;  ///< < 0: so far inside
  double friction = 0;    ///< of each joint, dry, which nobody compensates [N m]
  double payload = 0;     ///< which the arm was not told of [kg]
  bool alone = false;     ///< whether only the pushed joint can move: somebody holds the others
  double noise = 0;       ///< of measured positions [rad], and ten times as much a second of velocities
};
/// Limits that `home` is beyond: joints 0 and 1 beyond their upper, joint 2 beyond its lower end.
JointLimits<6> limits(double outside) {
  auto v = limits_of<ur5::Description>(15.0).values();
  v.upper[0] = Ur5::home[0] - outside, v.upper[1] = Ur5::home[1] - outside;
  v.lower[2] = Ur5::home[2] + outside;
  return JointLimits<6>(v);
}
auto arm(const Case& c) {
  return by_torque(ur5::Model{},
                   {.limits = limits(c.outside),
                    .period = c.loop.period,
                    .delay = c.loop.delay,
                    .viscous_friction = JointTorque<6>::constant(viscous),
                    .virtual_inertia = JointTorque<6>::constant(rotors)},
                   FrictionUncompensated{});
}
/// Calls `push(now, state)` for the torques of hands, `before(now, input)`, and `after(now, state, output)`.
template <class Scene, class Push, class Before, class After>
void run(const Case& c, const Scene& scene, Nanoseconds end, Push&& push, Before&& before, After&& after) {
  const auto real = Ur5::with(gripped(c.payload));
  State<6> x{0ns, Ur5::home, {}};
  Random random = seeded(11);
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, x);
  JointTorque<6> tau = memory->robot.command().torque;
  std::deque<std::pair<Nanoseconds, JointTorque<6>>> under_way;
  constexpr Nanoseconds step = 100us;
  for (Nanoseconds now = c.loop.period; now <= end; now += c.loop.period) {
    for (; x.time < now; x.time += step) {
      for (; !under_way.empty() && under_way.front().first <= x.time; under_way.pop_front())
        tau = under_way.front().second;
      JointTorque<6> acts = tau + push(now, x);
      for (std::size_t i = 0; i < 6; ++i)
        acts[i] -= c.friction * std::tanh(x.dq[i] / (1e-3 * std::max(1.0, c.friction)));
      auto motors = JointTorque<6>::constant(rotors);
      for (std::size_t i = 0; i < 6 && c.alone; ++i)
        if (i != pushed_joint) motors[i] = 1e9;
      x.dq = integrate(x.dq, acceleration(real, x, acts, motors), seconds<double>(step));
      x.q = integrate(x.q, x.dq, seconds<double>(step));
    }
    typename Scene::Input input;
    input.now = now;
    input.measured = x;
    for (std::size_t i = 0; i < 6 && c.noise > 0; ++i) {
      input.measured.q[i] += uniform(random, -c.noise, c.noise);
      input.measured.dq[i] += 10 * uniform(random, -c.noise, c.noise);
    }
    before(now, input);
    const auto out = scene.step(*memory, input);
    under_way.push_back({now + c.loop.delay, out.command.torque});
    after(now, x, out);
  }
}
constexpr auto untold = [](Nanoseconds, auto&) {};
JointTorque<6> at_pushed_joint(double torque) {
  JointTorque<6> tau;
  tau[pushed_joint] = torque;
  return tau;
}
double fastest(const State<6>& x) {
  double most = 0;
  for (const double v : x.dq) most = std::max(most, std::abs(v));
  return most;
}
/// The loop's delay D over 20 ms: what holds is as stiff as the delay allows.
double late(const Loop& loop) {
  return seconds<double>(loop.delay + 3 * loop.period / 2) / 0.02;
}

Case some_case(int k) {
  return {.loop = {(1 << k % 4) * 1ms, (k * 7 % 21) * 1ms},
          .outside = 0.01 * (k * 3 % 6),
          .friction = 1.5 * (k % 3)};
}

}  // namespace

TEST_CASE("MotionLimits: beyond its end a joint stays against what pushes it on") {
  for (int k = 0; k < (sanitized ? 2 : 16); ++k) {
    Case c = some_case(k);
    c.alone = true, c.payload = k % 2;
    const double torque = k % 2 == 0 ? 8 + c.friction : 0;
    CAPTURE(c.loop.period.count());
    CAPTURE(c.loop.delay.count());
    CAPTURE(c.outside);
    CAPTURE(c.friction);
    CAPTURE(c.payload);
    double moved = 0, rest = 0;
    run(
        c, Cycle(arm(c), GravityControl{}), 10s, [&](auto, auto&) { return at_pushed_joint(torque); }, untold,
        [&](Nanoseconds now, const State<6>& x, const auto&) {
          moved = std::max(moved, x.q[pushed_joint] - Ur5::home[pushed_joint]);
          if (now > 8s) rest = std::max(rest, fastest(x));
        });
    CHECK(moved < 0.01 + 0.05 * late(c.loop) * late(c.loop));
    CHECK(rest < 3e-3);
  }
}

TEST_CASE("MotionLimits: an arm that starts beyond ends does not move by itself") {
  for (int k = 0; k < (sanitized ? 2 : 12); ++k) {
    Case c = some_case(k);
    c.noise = k % 2 == 0 ? 0 : 1e-4;
    if (c.noise > 0) c.friction = 1;
    CAPTURE(c.loop.period.count());
    CAPTURE(c.loop.delay.count());
    CAPTURE(c.outside);
    CAPTURE(c.noise);
    double moved = 0;
    run(
        c, Cycle(arm(c), GravityControl{}), 20s, [](auto, auto&) { return JointTorque<6>(); }, untold,
        [&](auto, const State<6>& x, const auto&) {
          for (std::size_t i = 0; i < 6; ++i) moved = std::max(moved, std::abs(x.q[i] - Ur5::home[i]));
        });
    CHECK(moved < (c.noise > 0 ? 1e-3 : 2e-5));
  }
}

TEST_CASE("MotionLimits: a hand moves a joint back inside as if it had no end, and a law does") {
  for (int k = 0; k < (sanitized ? 2 : 12); ++k) {
    Case c = some_case(k);
    c.outside = 0.05;
    CAPTURE(c.loop.period.count());
    CAPTURE(c.loop.delay.count());
    CAPTURE(c.friction);
    const Cycle held(arm(c), GravityControl{});
    const auto pushed_back = [&](const auto& scene) {
      double way = 0;
      run(
          c, scene, 700ms, [&](Nanoseconds now, auto&) { return at_pushed_joint(now < 200ms ? 0 : -6); },
          untold,
          [&](auto, const State<6>& x, const auto&) { way = Ur5::home[pushed_joint] - x.q[pushed_joint]; });
      return way;
    };
    const double with = pushed_back(held), without = pushed_back(held.template without<MotionByTorque>());
    CHECK(with > 0.95 * without);
    CHECK(without > 0.02);

    const auto robot = arm(c);
    auto goal = Ur5::home;
    goal[0] -= 0.2, goal[1] -= 0.2, goal[2] += 0.2;
    double off = 0;
    run(
        c, Cycle(robot, SplineJoint<6>(tracking_settings(robot)) + GravityControl{}), 8s,
        [](auto, auto&) { return JointTorque<6>(); },
        [&](Nanoseconds now, auto& input) {
          if (now == c.loop.period) input.goal = {goal, 1500ms};
        },
        [&](auto, const State<6>& x, const auto&) {
          off = 0;
          for (std::size_t i = 0; i < 3; ++i) off = std::max(off, std::abs(x.q[i] - goal[i]));
        });
    CHECK(off < 0.1);
  }
}

TEST_CASE("MotionLimits: who is held down frees himself, and a joint that he lets go stays") {
  for (int k = 0; k < (sanitized ? 2 : 12); ++k) {
    Case c = some_case(k);
    c.alone = true;
    CAPTURE(c.loop.period.count());
    CAPTURE(c.loop.delay.count());
    CAPTURE(c.outside);
    CAPTURE(c.friction);
    bool gone = false;
    double led = 0, back = 0, fast = 0, rest = 0;
    run(
        c, Cycle(arm(c), GravityControl{}), 15s,
        [&](Nanoseconds now, const State<6>& x) {
          led = std::max(led, x.q[pushed_joint] - Ur5::home[pushed_joint]);
          gone = gone || led > 0.2;
          return at_pushed_joint(gone ? 0 : 60 * std::min(1.0, seconds<double>(now)));
        },
        untold,
        [&](Nanoseconds now, const State<6>& x, const auto&) {
          back = led - (x.q[pushed_joint] - Ur5::home[pushed_joint]);
          if (gone) fast = std::max(fast, -x.dq[pushed_joint]);
          if (now > 13s) rest = std::max(rest, fastest(x));
        });
    CHECK(gone);
    CHECK(back < 0.02 + 0.2 * late(c.loop) * late(c.loop));
    CHECK(fast < 1);
    CHECK(rest < 1e-3);
  }
}
