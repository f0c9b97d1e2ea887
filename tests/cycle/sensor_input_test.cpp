// What arrives from wrist sensors and motors: any bits, other scalars, configurations, a loop.
//
// Promise: whatever bits sensors send, and whenever, the command keeps its limits
// Tried: wrist sensor and motors together, random bits and stamps, 5000 cycles by position: speed limits
// kept, nothing not finite

#include <doctest/doctest.h>

#include <bit>
#include <memory>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

WristSensorSettings<5> at_flange(double gain = 1) {
  return {.X_LS = Transform<Link<5>, ForceSensor>::translation_xyz(0, 0, 0.1), .gain = gain};
}
template <class T, class Touch>
auto scene_with(const Touch& touch) {
  const auto robot_model = calibrated_from<ur5::Description, T>();
  return Cycle(
      by_position<T>(robot_model,
                     {.limits = limits_of<ur5::Description, T>(T(15)),
                      .period = 8ms,
                      .delay = 8ms,
                      .virtual_damping = T(4),
                      .virtual_inertia = JointTorque<6, T>::generate([](std::size_t) { return T(0.5); })}),
      touch, SkinJointControl{} + GravityControl{});
}
template <class T>
auto wrist_scene(double gain = 1) {
  return scene_with<T>(wrist_sensor<5, T>(calibrated_from<ur5::Description, T>(), at_flange(gain)));
}

/// A number of any bits, or a plausible one.
double any(Random& random) {
  if (random() % 3 == 0) return std::bit_cast<double>(random());
  return uniform(random, -100.0, 100.0);
}
Nanoseconds any_time(Random& random, Nanoseconds now) {
  switch (random() % 4) {
    case 0:
      return Nanoseconds(std::bit_cast<std::int64_t>(random()));
    case 1:
      return random() % 2 ? Nanoseconds::min() : Nanoseconds::max();
    default:
      return now - Nanoseconds(long(random() % 20000000));
  }
}

}  // namespace

TEST_CASE("Sensors: whatever bits they send, and whenever, the command keeps its limits") {
  const auto robot_model = calibrated_from<ur5::Description, double>();
  const auto scene =
      scene_with<double>(wrist_sensor<5>(robot_model, at_flange()) +
                         MotorTouch(robot_model, {.gates = same_gate(robot_model, EventGate<>(2, 1, 1))}));
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto limits = limits_of<ur5::Description>(15.0);
  auto random = seeded(12);
  const auto memory = std::make_unique<Scene::Memory>();
  Status all;
  for (int run = 0; run < (sanitized ? 5 : 50); ++run) {
    scene.start(*memory, {0ns, home, {}});
    auto last = home;
    for (int k = 1; k <= 100; ++k) {
      const Nanoseconds now = 8ms * k;
      std::vector<WrenchSample> samples(random() % 4);
      for (WrenchSample& s : samples) {
        s.time = any_time(random, now);
        for (double& x : s.force) x = any(random);
        for (double& x : s.moment) x = any(random);
      }
      Scene::Input input;
      input.now = now;
      input.measured = {any_time(random, now), last, {}};
      if (random() % 8 == 0) input.measured.dq[random() % 6] = any(random);
      input.sensed.wrenches = samples;
      for (double& x : input.sensed.motor_torque) x = any(random);
      const auto out = scene.step(*memory, input);
      all |= out.status;
      if (!out.command.valid) continue;
      for (std::size_t i = 0; i < 6; ++i) {
        REQUIRE(std::isfinite(out.command.position[i]));
        REQUIRE(std::abs(out.command.position[i] - last[i]) <= 0.008 * limits.velocity()[i] * (1 + 1e-9));
      }
      last = out.command.position;
    }
  }
  for (const Reason r :
       {Reason::sample_not_finite, Reason::sample_out_of_range, Reason::sample_stale, Reason::time_backwards})
    CHECK(all.has(r));
}

TEST_CASE("Sensors: an arm in float gives way as one in double") {
  const auto led = []<class T>(const auto& scene, T) {
    using Scene = std::remove_cvref_t<decltype(scene)>;
    const auto memory = std::make_unique<typename Scene::Memory>();
    auto q = home.cast<T>();
    scene.start(*memory, {0ns, q, {}});
    for (int k = 1; k <= 100; ++k) {
      const WrenchSample sample{8ms * k, {20, 5, -10}, {0.5, 0, 1}};
      typename Scene::Input input;
      input.now = 8ms * k;
      input.measured = {input.now, q, {}};
      input.sensed.wrenches = {&sample, 1};
      q = scene.step(*memory, input).command.position;
    }
    return q;
  };
  const auto wide = led(wrist_scene<double>(), 0.0);
  const auto narrow = led(wrist_scene<float>(), 0.0f);
  double moved = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(double(narrow[i]) - wide[i]) <= 1e-4);
    moved = std::max(moved, std::abs(wide[i] - home[i]));
  }
  CHECK(moved > 0.1);
}

TEST_CASE("Sensors: the gain of a wrist sensor changes while the arm is led, without a step") {
  const Configurations scene(wrist_scene<double>(1), wrist_scene<double>(2));
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  auto q = home;
  scene.start(*memory, {0ns, q, {}});
  double before = 0, largest = 0, speed = 0, twice = 0;
  for (int k = 1; k <= 400; ++k) {
    const WrenchSample sample{8ms * k, {0, 6, 0}, {0, 0, 0}};
    Scene::Input input;
    input.now = 8ms * k;
    input.measured = {input.now, q, {}};
    input.sensed.wrenches = {&sample, 1};
    input.configuration = k < 100 ? 0 : 1;
    const auto out = scene.step(*memory, input);
    speed = (out.command.position[4] - q[4]) / 0.008;
    if (k >= 98 && k < 106) largest = std::max(largest, std::abs(speed - before));
    if (k == 99) twice = speed;
    if (k == 160) CHECK(speed / twice > 1.3);
    before = speed;
    q = out.command.position;
  }
  CHECK(largest < 0.2 * std::abs(twice));
}

TEST_CASE("Sensors: a loop takes a robot's wrenches, and keeps those of the worst cycle") {
  struct Robot {
    State<6> state{0ns, home, {}};
    JointPosition<6> next = home;
    std::vector<WrenchSample> samples{1};
    Heard wait(State<6>& measured) noexcept {
      state.time += 8ms;
      state.q = next;
      measured = state;
      return Heard::state;
    }
    bool send(const PositionCommand<6>& command) noexcept {
      next = command.position;
      return true;
    }
    void stop() noexcept {}
    std::span<const WrenchSample> wrenches() noexcept {
      samples[0] = {state.time, {0, 10, 0}, {0, 0, 0}};
      return samples;
    }
  } robot;
  const auto scene = wrist_scene<double>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  NoSkin none;
  Status all;
  const auto report = run_loop(
      scene, *memory, robot, none, {.cycles = 100}, [](auto&, auto&) { return true; },
      [&](const auto&, const auto& out, const auto&) { all |= out.status; });
  CHECK(report.ended == LoopEnd::finished);
  CHECK_FALSE(all.has(Reason::sample_stale));
  double moved = 0;
  for (std::size_t i = 0; i < 6; ++i) moved = std::max(moved, std::abs(robot.next[i] - home[i]));
  CHECK(moved > 0.02);
  const auto kept = report.worst->input.sensed.wrenches;
  REQUIRE(kept.size() == 1);
  CHECK(kept.data() == report.worst->wrenches.data());
  CHECK(kept[0].force[1] == 10);
}

TEST_CASE("Sensors: contact limits of the link with the sensor stop an arm that presses too hard") {
  const LinkContact<5> limit{
      .region = {.force = 60, .blow = 120, .first = 100ms, .stiffness = 3e4, .mass = 5},
      .reach = 0.3,
      .reaction_time = 24ms};
  const auto scene = wrist_scene<double>().with(limit);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto pressed = [&](double force) {
    const auto memory = std::make_unique<typename Scene::Memory>();
    auto q = home;
    scene.start(*memory, {0ns, q, {}});
    Status all;
    for (int k = 1; k <= 50; ++k) {
      const WrenchSample sample{8ms * k, {0, 0, force}, {0, 0, 0}};
      Scene::Input input;
      input.now = 8ms * k;
      input.measured = {input.now, q, {}};
      input.sensed.wrenches = {&sample, 1};
      const auto out = scene.step(*memory, input);
      all |= out.status;
      q = out.command.position;
    }
    return all;
  };
  CHECK_FALSE(pressed(40).has(Reason::contact_force));
  CHECK(pressed(80).has(Reason::contact_force));   // for longer than 100 ms
  CHECK(pressed(150).has(Reason::contact_force));  // at once
}

TEST_CASE("Sensors: an arm by torque gets gravity and the push at its tool, to rounding") {
  const ur5::Model model;
  WristSensorSettings<5> settings = at_flange();
  settings.force = EventGate<>(), settings.moment = EventGate<>();
  const auto sensor = wrist_sensor<5>(model, settings);
  const Cycle scene(by_torque(model, {.limits = limits_of<ur5::Description>(15.0), .period = 1ms},
                              RobotCompensatesFriction{}),
                    sensor, SkinJointControl{} + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  scene.start(*memory, {0ns, home, {}});
  typename Scene::Output out;
  for (int k = 1; k <= 100; ++k) {
    // None about the last axis, whose light joint its limits of motion would hold back.
    const WrenchSample sample{1ms * k, {3, -4, 5}, {0.1, 0.2, 0}};
    Scene::Input input;
    input.now = 1ms * k;
    input.measured = {input.now, home, {}};
    input.sensed.wrenches = {&sample, 1};
    out = scene.step(*memory, input);
  }
  REQUIRE(out.command.valid);
  const auto expected = gravity_torque(model, home) + skin_torque(model, home, sensor.wrenches(memory->skin));
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out.command.torque[i] - expected[i]) <= 1e-9);
  CHECK(std::abs(skin_torque(model, home, sensor.wrenches(memory->skin))[1]) > 0.5);
}
