// runs long: minutes of pushes
// Promise: a wrist sensor's bias does not lead an arm, and a hand does
// Tried: an arm that nothing leads back, 50 N s/m: 4 N of bias move it 8 mm in 10 s (396 unwatched), 20 N
// 11 mm, one that grows by 0.1 to 1 N/s at most 16; each is named and tared; hands of 300 N/m lead it as
// far as without the watch at 10 to 200 mm/s, with and without tremor

#include "skinctl/tactile/push_watch.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robot/preset.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "skinctl/testing/hand.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const ur5::Model model;
const auto X_LS = Transform<Link<5>, ForceSensor>::translation_xyz(0, 0, 0.1);
const JointPosition<6> home{0, -1.2, 1.4, -1.8, -1.57, 0.3};

Transform<Base, ForceSensor> sensor_at(const JointPosition<6>& q) {
  return Poses<ur5::Model, all_links(6)>(model, JointAngles<ur5::Model, double>(model, q)).get<5>() * X_LS;
}
/// 5 kg and 50 N s/m at the sensor, without anything that leads it back.
auto free_arm() {
  using Shape = ToolShape<5>;
  return by_position(
      model, {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 0},
      Shape({.X_LT = X_LS.renamed<Link<5>, Tool>(),
             .mass = Shape::diagonal({5, 5, 5, 0.3, 0.3, 0.3}),
             .damping = Shape::diagonal({50, 50, 50, 3, 3, 3})}));
}

struct Course {
  double moved = 0, farthest = 0;  // of the tool from its place, in the end and at most [mm]
  double turned = 0;               // of the tool [rad]
  double peak = 0;                 // force of the hand [N]
  double bias = 0;                 // found, along the sensor's z axis [N]
  unsigned tares = 0;
  Status status;
};
/// The arm for `duration`, pushed along the base's x by `push(t, x)` [N], x the way of the tool; its sensor
/// reads `bias(t)` besides, along its own z axis, and after a second `turning` [N m] about its x axis.
Course run(double duration, const std::function<double(double)>& bias,
           const std::function<double(double, double)>& push, bool watched = true, double turning = 0) {
  const auto sensor = wrist_sensor<5>(model, {.X_LS = X_LS,
                                              .force = EventGate<>::dead_band(2),
                                              .moment = EventGate<>::dead_band(0.2),
                                              .noise = watched ? 0.05 : 0,
                                              .moment_noise = watched ? 0.002 : 0});
  const Cycle scene(free_arm(), sensor, SkinJointControl{} + GravityControl{});
  const auto memory = std::make_unique<typename decltype(scene)::Memory>();
  State<6> measured{0ns, home, {}};
  scene.start(*memory, measured);
  auto under_way = home;
  Seeded random(11);
  Course out;
  const auto start = sensor_at(home).origin();
  while (seconds<double>(measured.time) < duration) {
    measured.time += 8ms;
    measured.q = under_way;
    const double t = seconds<double>(measured.time);
    const auto X = sensor_at(measured.q);
    const Xyz<double> way = X.origin() - start;
    const double force = push(t, way.x);
    const Xyz<double> f = X.axes().transpose() * Xyz<double>{force, 0, 0};
    const auto n = [&] {
      return 0.05 * (random.between(-1, 1) + random.between(-1, 1) + random.between(-1, 1));
    };
    const WrenchSample sample{
        measured.time, {f.x + n(), f.y + n(), f.z + bias(t) + n()}, {t > 1 ? turning : 0, 0, 0}};
    typename decltype(scene)::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.sensed.wrenches = {&sample, 1};
    const auto step = scene.step(*memory, input);
    under_way = step.command.position;
    out.status |= step.status;
    const Xyz<double> turn = log_so3(X.axes() * sensor_at(home).axes().transpose());
    out.turned = std::max(out.turned, std::sqrt(dot(turn, turn)));
    out.moved = 1e3 * std::sqrt(dot(way, way));
    out.farthest = std::max(out.farthest, out.moved);
    out.peak = std::max(out.peak, force);
  }
  out.tares = memory->skin.watch.tares;
  out.bias = sensor.bias(memory->skin).force.z;
  return out;
}
double none(double) {
  return 0;
}
double nobody(double, double) {
  return 0;
}

/// A hand that comes at `from` [s] and goes `way` [m] at `speed` [m/s]. A tremor of 0.2 N is 2 % of 10 N.
auto leading(double way, double speed, double tremor, double from = 1) {
  auto s = leading_hand();
  s.tremor = tremor;
  return [hand = std::make_shared<Hand>(s), way, speed, from](double t, double x) {
    const double goal = std::min(way, std::max(0.0, (t - from) * speed));
    double force = 0;
    for (int k = 0; k < 80; ++k) force += hand->advance(1e-4, goal, x) / 80;
    return force;
  };
}

double step_of(double size, double t) {
  return t > 1 ? size : 0;
}
/// Grows by `rate` [N/s] at first, and ends at 6 N: a sensor that warms up.
double creeping(double rate, double t) {
  return t > 1 ? 6 * (1 - std::exp((1 - t) * rate / 6)) : 0;
}

}  // namespace

TEST_CASE("PushWatch: a bias moves an arm that nothing leads back by 15 mm at most, and is named and tared") {
  const Course believed = run(11, [](double t) { return step_of(4, t); }, nobody, false);
  CHECK(believed.moved > 390);  // 4 N less 2 N over 50 N s/m for 10 s
  CHECK_FALSE(believed.status.has(Reason::push_without_life));
  for (const double size : {2.5, 4.0, 8.0, 20.0}) {
    CAPTURE(size);
    const Course c = run(5, [&](double t) { return step_of(size, t); }, nobody);
    CHECK(c.farthest < 12);
    CHECK(c.status.has(Reason::push_without_life));
    CHECK(c.tares == 1);
    CHECK(c.bias == doctest::Approx(size).epsilon(0.05));
  }
  for (const double rate : {0.1, 0.3, 1.0}) {
    CAPTURE(rate);
    const Course c = run(60, [&](double t) { return creeping(rate, t); }, nobody);
    CHECK(c.farthest < 16);
    CHECK(c.tares >= 1);
  }
  // Slower than the rest follows: nothing moves at all.
  const Course slow = run(40, [](double t) { return creeping(0.02, t); }, nobody);
  CHECK(slow.farthest < 0.1);
  CHECK(slow.tares == 0);
}

TEST_CASE("PushWatch: a hand leads as without it, however slow, with and without tremor") {
  for (const double speed : {0.01, 0.02, 0.05, 0.2})
    for (const double tremor : {0.0, 0.2}) {
      CAPTURE(speed);
      CAPTURE(tremor);
      const double duration = 3 + 0.2 / speed;
      const Course believed = run(duration, none, leading(0.2, speed, tremor), false);
      const Course c = run(duration, none, leading(0.2, speed, tremor));
      CHECK(c.moved > 193);  // of the hand's 200 mm: the dead band is 2 N of 300 N/m
      CHECK(std::abs(c.moved - believed.moved) < 0.5);
      CHECK(c.peak < believed.peak + (tremor > 0 ? 0.3 : 2.7));  // a calm one is asked: it pushes harder
      CHECK(c.tares == 0);
    }
}

TEST_CASE("PushWatch: behind a bias that was tared a hand leads, and a bias in a moment is one, too") {
  const Course c = run(13, [](double t) { return step_of(4, t); }, leading(0.2, 0.05, 0.2, 5));
  CHECK(c.tares == 1);
  CHECK(c.moved > 185);
  const Course turned = run(6, none, nobody, true, 0.8);
  CHECK(turned.status.has(Reason::push_without_life));
  CHECK(turned.turned < 0.1);
  CHECK(run(6, none, nobody, false, 0.8).turned > 0.5);
}

TEST_CASE("PushWatch: nonsense is refused, and its memory is plain") {
  static_assert(std::is_trivially_copyable_v<PushWatch<6, 2>::Memory>);
  const auto refused = [](double noise, double creep) {
    try {
      static_cast<void>(PushWatch<1, 1>({}, {noise}, {creep}));
    } catch (const ConfigurationError&) {
      return true;
    }
    return false;
  };
  CHECK_FALSE(refused(0, 0));
  CHECK(refused(-1, 0));
  CHECK(refused(std::numeric_limits<double>::quiet_NaN(), 0));
  CHECK(refused(1, -1));
  CHECK(refused(1, std::numeric_limits<double>::infinity()));
}
