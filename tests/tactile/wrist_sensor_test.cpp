// runs long: a loop for each robot
// Promise: an arm without skin gives way at its tool, as configured, and its tool's weight is no touch
// Tried: a force-torque sensor, a tool of 1 kg: 10 N and 1 N m in all six directions, both ways, velocity
// within 5 % of the tool shape's in each coordinate; untouched for 10 s it does not move by a bit
//
// Promise: a wrist sensor's impulse arrives, whatever the rate of the cycle
// Tried: irregular samples up to 13 ms late, irregular cycles: to 1e-9 N s

#include "skinctl/tactile/wrist_sensor.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <vector>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/mounted.hpp"
#include "skinctl/model/weightless.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/contact.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using V3 = std::array<double, 3>;
constexpr double nan_v = std::numeric_limits<double>::quiet_NaN();
const ur5::Model model;
/// The sensor sits 30 mm beyond the flange, turned by 0.4 rad and on its side.
const auto X_LS =
    Transform<Link<5>, ForceSensor>::translation_xyz(0.01, 0, 0.112).rotated_z(0.4).rotated_x(0.9);
constexpr double tool_mass = 1.0;
constexpr Xyz<double> tool_centre{0.02, -0.01, 0.06};

/// Without thresholds: what is read is what is felt.
WristSensorSettings<5> open_settings() {
  return {.X_LS = X_LS, .force = EventGate<>(), .moment = EventGate<>()};
}

Transform<Base, ForceSensor> sensor_at(const JointPosition<6>& q) {
  return Poses<ur5::Model, all_links(6)>(model, JointAngles<ur5::Model, double>(model, q)).get<5>() * X_LS;
}
/// The reading of a sensor that carries the tool while a hand pushes with this wrench, along the base's axes,
/// at the sensor's origin. Written out: what the earth and the hand do to the tool.
WrenchSample reading(Nanoseconds time, const JointPosition<6>& q, const Xyz<double>& push,
                     const Xyz<double>& turn, double mass, const Xyz<double>& down = {0, 0, -9.81}) {
  const auto R = sensor_at(q).axes();
  const Xyz<double> pull = mass * down;
  const Xyz<double> arm = R * tool_centre;
  const Xyz<double> f = push + pull, m = turn + cross(arm, pull);
  const auto along = [&](const Xyz<double>& x) { return V3{dot(R.x, x), dot(R.y, x), dot(R.z, x)}; };
  return {time, along(f), along(m)};
}
/// Of the force.
double size(const LinkWrenches<ur5::Model, link_bit<5>>& w) {
  const double* f = w.data[0];
  return std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
}

}  // namespace

TEST_CASE("WristSensor: a push does the work in the joints that it does at the tool") {
  const auto sensor = wrist_sensor<5>(model, open_settings());
  Seeded random(5);
  for (int k = 0; k < 200; ++k) {
    JointPosition<6> q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = random.between(-3, 3);
    const Xyz<double> push{random.between(-50, 50), random.between(-50, 50), random.between(-50, 50)};
    auto memory = sensor.start(0ns);
    const WrenchSample samples[] = {reading(1ms, q, push, {0, 0, 0}, 0)};
    LinkWrenches<ur5::Model, link_bit<5>> mean;
    const State<6> at{1ms, q, {}};
    CHECK_FALSE(sensor.receive(memory, {}, {samples}, at, 0ns, 1ms, 1, &mean).any());
    const auto tau = skin_torque(model, q, sensor.wrenches(memory));
    // By the principle of virtual work, with central differences of the sensor's place.
    for (std::size_t i = 0; i < 6; ++i) {
      auto ahead = q, behind = q;
      ahead[i] += 1e-6, behind[i] -= 1e-6;
      const Xyz<double> way = 0.5e6 * (sensor_at(ahead).origin() - sensor_at(behind).origin());
      CHECK(std::abs(tau[i] - dot(way, push)) <= 1e-7);
    }
  }
}

TEST_CASE("WristSensor: a UR's actual_TCP_force, along the base's axes at the TCP") {
  const auto sensor = wrist_sensor<5>(model, open_settings());
  const JointPosition<6> q{0.3, -1.2, 1.4, -1.8, -1.57, 0.3};
  const auto R = sensor_at(q).axes();
  const auto sample = sensor.from_base_axes(7ms, {1, 2, 3, 0.4, 0.5, 0.6}, q);
  CHECK(sample.time == 7ms);
  const Xyz<double> f{1, 2, 3}, m{0.4, 0.5, 0.6};
  const Xyz<double>* axes[] = {&R.x, &R.y, &R.z};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(sample.force[i] == doctest::Approx(dot(*axes[i], f)));
    CHECK(sample.moment[i] == doctest::Approx(dot(*axes[i], m)));
  }
}

TEST_CASE("WristSensor: the weight of the tool is no touch, at any pose and for any mounting") {
  const Mounted<ur5::Model> hanging(model, Transform<World, Base>::rotation_x(2.1).axes());
  const auto down = gravity_in_base(Transform<World, Base>::rotation_x(2.1).axes(), 9.81);
  auto settings = open_settings();
  settings.mass = tool_mass, settings.centre = tool_centre;
  const auto upright = wrist_sensor<5>(model, settings);
  const auto tilted = wrist_sensor<5>(hanging, settings);
  const auto weightless = wrist_sensor<5>(model, open_settings());
  Seeded random(6);
  for (int k = 0; k < 200; ++k) {
    JointPosition<6> q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = random.between(-3, 3);
    const State<6> at{1ms, q, {}};
    const auto felt = [&](const auto& sensor, const Xyz<double>& g) {
      auto memory = sensor.start(0ns);
      const WrenchSample samples[] = {reading(1ms, q, {0, 0, 0}, {0, 0, 0}, tool_mass, g)};
      typename std::remove_cvref_t<decltype(sensor)>::Wrenches mean;
      CHECK_FALSE(sensor.receive(memory, {}, {samples}, at, 0ns, 1ms, 1, &mean).any());
      double sum = 0;
      for (const double x : sensor.wrenches(memory).data[0]) sum += std::abs(x);
      return sum;
    };
    CHECK(felt(upright, {0, 0, -9.81}) <= 1e-12);
    CHECK(felt(tilted, down) <= 1e-12);
    CHECK(felt(weightless, {0, 0, -9.81}) > 9.8);
  }
}

TEST_CASE("WristSensor: the bias is found at rest, and refused where somebody touches") {
  auto settings = open_settings();
  settings.mass = tool_mass, settings.centre = tool_centre;
  settings.force = EventGate<>::dead_band(2), settings.moment = EventGate<>::dead_band(0.2);
  const auto sensor = wrist_sensor<5>(model, settings);
  const JointPosition<6> q{0.3, -1.2, 1.4, -1.8, -1.57, 0.3};
  Seeded random(7);
  std::vector<WrenchSample> samples;
  for (int k = 0; k < 1000; ++k) {
    samples.push_back(reading(Nanoseconds(k * 1000000), q, {0, 0, 0}, {0, 0, 0}, tool_mass));
    const double bias[] = {4, -7, 11, 0.3, -0.5, 0.1};
    for (std::size_t i = 0; i < 3; ++i) {
      samples.back().force[i] += bias[i] + random.between(-0.3, 0.3);
      samples.back().moment[i] += bias[3 + i] + random.between(-0.02, 0.02);
    }
  }
  const auto bias = sensor.tared(samples, q).settings().bias;
  CHECK(std::abs(bias.force.x - 4) < 0.02);
  CHECK(std::abs(bias.force.y + 7) < 0.02);
  CHECK(std::abs(bias.force.z - 11) < 0.02);
  CHECK(std::abs(bias.moment.x - 0.3) < 0.002);
  CHECK(std::abs(bias.moment.y + 0.5) < 0.002);
  CHECK(std::abs(bias.moment.z - 0.1) < 0.002);
  auto touched = samples;
  for (std::size_t k = 500; k < 520; ++k) touched[k].force[0] += 2;
  CHECK_THROWS_AS(static_cast<void>(sensor.tared(touched, q)), ConfigurationError);
  touched = samples;
  touched[3].moment[1] = nan_v;
  CHECK_THROWS_AS(static_cast<void>(sensor.tared(touched, q)), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(sensor.tared(std::span(samples).first(9), q)), ConfigurationError);
}

TEST_CASE(
    "WristSensor: the impulse is that of the line through the samples, whatever the rate of the cycle") {
  const auto sensor = wrist_sensor<5>(model, open_settings());
  Seeded random(8);
  for (int run = 0; run < 40; ++run) {
    // Irregular samples, which arrive up to 6 ms late; irregular cycles.
    std::vector<WrenchSample> sent;
    for (Nanoseconds t = 10ms; t < 400ms; t += Nanoseconds(500000 + int(random.between(0, 9e6)))) {
      const double f = sent.empty() || t > 300ms ? 0 : random.between(-20, 20);
      sent.push_back({t, {0, 0, f}, {0, 0, 0}});
    }
    double expected = 0;
    for (std::size_t k = 1; k < sent.size(); ++k)
      expected +=
          seconds<double>(sent[k].time - sent[k - 1].time) * 0.5 * (sent[k].force[2] + sent[k - 1].force[2]);
    auto memory = sensor.start(0ns);
    double impulse = 0;
    std::size_t next = 0;
    for (Nanoseconds from = 0ns; from < 450ms;) {
      const Nanoseconds to = from + Nanoseconds(1000000 + int(random.between(0, 9e6)));
      const std::size_t first = next;
      while (next < sent.size() && sent[next].time + 3ms <= to) ++next;
      LinkWrenches<ur5::Model, link_bit<5>> mean[4];
      const WristInput input{std::span(sent).subspan(first, next - first)};
      const State<6> at{to, {}, {}};
      sensor.receive(memory, {}, input, at, from, to, 4, mean);
      for (const auto& m : mean)
        impulse += seconds<double>(to - from) / 4 *
                   dot(X_LS.axes().z, Xyz<double>{m.data[0][0], m.data[0][1], m.data[0][2]});
      from = to;
    }
    CAPTURE(run);
    CHECK(std::abs(impulse - expected) <= 1e-9);
  }
}

TEST_CASE("WristSensor: what cannot be is refused with its reason, and a silent sensor lets go") {
  auto settings = open_settings();
  const auto sensor = wrist_sensor<5>(model, settings);
  auto memory = sensor.start(0ns);
  const State<6> at{};
  LinkWrenches<ur5::Model, link_bit<5>> mean[2];
  const auto give = [&](const WrenchSample& s, Nanoseconds from, Nanoseconds to) {
    const WrenchSample samples[] = {s};
    return sensor.receive(memory, {}, {samples}, at, from, to, 2, mean);
  };
  CHECK(sensor.receive(memory, {}, {}, at, 0ns, 2ms, 2, mean) == Status(Reason::sample_stale));
  CHECK(give({3ms, {nan_v, 0, 0}, {0, 0, 0}}, 2ms, 4ms).has(Reason::sample_not_finite));
  CHECK(give({5ms, {0, 1001, 0}, {0, 0, 0}}, 4ms, 6ms).has(Reason::sample_out_of_range));
  CHECK(size(mean[1]) == 0);
  CHECK_FALSE(give({8ms, {0, 0, 10}, {0, 0, 0}}, 6ms, 8ms).any());
  CHECK(give({8ms, {0, 0, 90}, {0, 0, 0}}, 8ms, 10ms) == Status(Reason::time_backwards));
  CHECK(give({7ms, {0, 0, 90}, {0, 0, 0}}, 10ms, 12ms) == Status(Reason::time_backwards));
  CHECK(give({15ms, {0, 0, 90}, {0, 0, 0}}, 12ms, 12500us) == Status(Reason::sample_out_of_range));
  CHECK(std::abs(size(mean[1]) - 10) < 1e-12);
  const CellSample cell{.cell = 3};
  CHECK(sensor.receive(memory, {&cell, 1}, {}, at, 12500us, 13ms, 2, mean) == Status(Reason::sample_unknown));
  // Held until 25 ms before the end, then a line to zero.
  sensor.receive(memory, {}, {}, at, 13ms, 33ms, 2, mean);
  CHECK(std::abs(size(mean[1]) - 10) < 1e-12);
  CHECK_FALSE(sensor.receive(memory, {}, {}, at, 33ms, 53ms, 2, mean).any());
  CHECK(std::abs(size(mean[0]) - 8) < 1e-9);
  CHECK(std::abs(size(mean[1]) - 4) < 1e-9);
  CHECK(sensor.receive(memory, {}, {}, at, 53ms, 63ms, 2, mean) == Status(Reason::sample_stale));
  CHECK(std::abs(size(mean[0]) - 1) < 1e-9);
  CHECK(size(mean[1]) < 1e-9);
  CHECK(size(sensor.wrenches(memory)) == 0);
  // It comes back by itself, without a blow for the time of its silence.
  CHECK_FALSE(give({100ms, {0, 0, 10}, {0, 0, 0}}, 98ms, 102ms).any());
  CHECK(size(mean[1]) <= 10 + 1e-12);
  CHECK(give({40ms, {0, 0, 10}, {0, 0, 0}}, 102ms, 104ms).has(Reason::time_backwards));
  // A clock that was set back costs one interval.
  give({20ms, {0, 0, 5}, {0, 0, 0}}, 18ms, 20ms);
  CHECK_FALSE(give({22ms, {0, 0, 5}, {0, 0, 0}}, 20ms, 22ms).any());
  CHECK(std::abs(sensor.wrenches(memory).data[0][0] * X_LS.axes().z.x +
                 sensor.wrenches(memory).data[0][1] * X_LS.axes().z.y +
                 sensor.wrenches(memory).data[0][2] * X_LS.axes().z.z - 5) < 1e-12);
}

TEST_CASE("WristSensor: nonsense is refused where it is built") {
  const auto built = [](auto change) {
    auto s = open_settings();
    change(s);
    static_cast<void>(wrist_sensor<5>(model, s));
  };
  CHECK_NOTHROW(built([](auto&) {}));
  CHECK_THROWS_AS(built([](auto& s) { s.mass = -1; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.mass = nan_v; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.gain = 0; }), ConfigurationError);
  WristSensorSettings<5> loaded{.mass = 1};
  CHECK_THROWS_AS(static_cast<void>(wrist_sensor<5>(Weightless<ur5::Model>(model), loaded)),
                  ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.centre.x = nan_v; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.bias.force.z = nan_v; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.fade = 0ns; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.max_age = 1ms; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.ramp = 0ns; }), ConfigurationError);
  CHECK_THROWS_AS(built([](auto& s) { s.max_force = 0; }), ConfigurationError);
}

namespace {

/// An arm without skin that carries a tool of 1 kg behind its sensor.
template <class Scene>
class LedArm {
 public:
  explicit LedArm(const Scene& scene, const JointPosition<6>& q)
      : scene_(scene),
        joints_(SimulatedJoints<6>::Kind::position, 0.008, 0, std::to_array(q.data)),
        memory_(std::make_unique<typename Scene::Memory>()) {
    measured_.q = q;
    scene_.start(*memory_, measured_);
  }
  /// A cycle of 8 ms; the sensor sends every 2 ms.
  Status step(const Xyz<double>& push, const Xyz<double>& turn) {
    std::array<WrenchSample, 4> samples;
    for (std::size_t k = 0; k < 4; ++k) {
      const Nanoseconds t = measured_.time + Nanoseconds(2000000 * (long(k) + 1));
      joints_.advance(seconds<double>(t));
      JointPosition<6> q;
      for (std::size_t i = 0; i < 6; ++i) q[i] = joints_.q()[i];
      samples[k] = reading(t, q, push, turn, tool_mass);
    }
    measured_.time += 8ms;
    for (std::size_t i = 0; i < 6; ++i) measured_.q[i] = joints_.q()[i], measured_.dq[i] = joints_.dq()[i];
    typename Scene::Input input;
    input.now = measured_.time;
    input.measured = measured_;
    input.sensed.wrenches = samples;
    const auto out = scene_.step(*memory_, input);
    recorded(input, out.planned);
    joints_.command(seconds<double>(measured_.time), std::to_array(out.command.position.data));
    return out.status;
  }
  [[nodiscard]] const JointPosition<6>& q() const { return measured_.q; }
  std::function<void(const typename Scene::Input&, const JointCommand<6>&)> recorded = [](const auto&,
                                                                                          const auto&) {};

 private:
  const Scene& scene_;
  SimulatedJoints<6> joints_;
  std::unique_ptr<typename Scene::Memory> memory_;
  State<6> measured_;
};

constexpr double mass = 5, inertia = 0.3, damping = 50, turning = 3;
auto tool_shaped_arm() {
  using Shape = ToolShape<5, 6>;
  return by_position(
      model, {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 0},
      Shape({.X_LT = X_LS.renamed<Link<5>, Tool>(),
             .mass = Shape::diagonal({mass, mass, mass, inertia, inertia, inertia}),
             .damping = Shape::diagonal({damping, damping, damping, turning, turning, turning})}));
}
const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

}  // namespace

TEST_CASE("WristSensor: an arm without skin gives way at its tool as configured, in all six directions") {
  WristSensorSettings<5> settings{.X_LS = X_LS, .mass = tool_mass, .centre = tool_centre};
  const Cycle scene(tool_shaped_arm(), wrist_sensor<5>(model, settings),
                    SkinJointControl{} + GravityControl{});
  for (std::size_t axis = 0; axis < 6; ++axis)
    for (const double sign : {1.0, -1.0}) {
      LedArm arm(scene, home);
      Xyz<double> push{0, 0, 0}, turn{0, 0, 0};
      const double given = axis < 3 ? 10 : 1, felt = axis < 3 ? 8 : 0.8;  // 2 N and 0.2 N m are the dead band
      double* const components[] = {&push.x, &push.y, &push.z, &turn.x, &turn.y, &turn.z};
      *components[axis] = sign * given;
      for (int k = 0; k < 75; ++k) arm.step(push, turn);
      const auto before = sensor_at(arm.q());
      for (int k = 0; k < 10; ++k) arm.step(push, turn);
      const auto after = sensor_at(arm.q());
      const Xyz<double> v = (1 / 0.08) * (after.origin() - before.origin());
      const Xyz<double> w = (1 / 0.08) * log_so3(after.axes() * before.axes().transpose());
      const double moved[] = {damping * v.x, damping * v.y, damping * v.z,
                              turning * w.x, turning * w.y, turning * w.z};
      CAPTURE(axis);
      for (std::size_t i = 0; i < 6; ++i) {
        CAPTURE(i);
        // 5 % of the push; of the other kind, 5 % of it on a lever of 0.1 m.
        const double scale = (i < 3) == (axis < 3) ? felt : (i < 3 ? felt / 0.1 : felt * 0.1);
        CHECK(std::abs(moved[i] - (i == axis ? sign * felt : 0)) <= 0.05 * scale);
      }
    }
}

TEST_CASE(
    "WristSensor: with a tool of 1 kg an untouched arm rests, to the bit, and one with a skin as well") {
  WristSensorSettings<5> settings{.X_LS = X_LS, .mass = tool_mass, .centre = tool_centre};
  const Cycle scene(tool_shaped_arm(), wrist_sensor<5>(model, settings),
                    SkinJointControl{} + GravityControl{});
  LedArm arm(scene, home);
  Recording<std::remove_cvref_t<decltype(scene)>> recording(std::size_t(1) << 22);
  recording.start({{}, home, {}});
  arm.recorded = [&](const auto& input, const auto& command) { recording.add(input, command); };
  Status all;
  for (int k = 0; k < 1250; ++k) all |= arm.step({0, 0, 0}, {0, 0, 0});
  CHECK_FALSE((all & Status(Reason::sample_stale)).any());
  for (std::size_t i = 0; i < 6; ++i) CHECK(arm.q()[i] == home[i]);
  // It is led elsewhere, left alone, and rests there.
  for (int k = 0; k < 100; ++k) arm.step({15, -10, 12}, {0, 0.5, 0});
  for (int k = 0; k < 250; ++k) arm.step({0, 0, 0}, {0, 0, 0});
  const auto there = arm.q();
  for (int k = 0; k < 250; ++k) arm.step({0, 0, 0}, {0, 0, 0});
  double moved = 0, rested = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    moved = std::max(moved, std::abs(there[i] - home[i]));
    rested = std::max(rested, std::abs(arm.q()[i] - there[i]));
  }
  CHECK(moved > 0.1);
  CHECK(rested <= 1e-9);
  // What was recorded is replayed bit for bit, the sensor's samples with it.
  const auto replayed = replay(scene, recording);
  CHECK(replayed.cycles == 1850);
  CHECK(replayed.different == 0);
  CHECK_FALSE(recording.full());
}
