// Promise: on a base that drives and tilts an arm does not take its own weight for a touch
// Tried: wrist sensor with a tool of 1 kg, motors, a robot that tells contacts: untouched they do not move
// the arm at 2 m/s^2 and 0.3 rad; a push of 15 N is felt as at rest, to 1e-9 N

#include <doctest/doctest.h>

#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/moving_base.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/robot_observer.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

using namespace skinctl;

namespace {

const JointPosition<6> home{0.4, -1.2, 1.4, -1.0, -1.3, 0.3};
constexpr double g = 9.81, tool_mass = 1;
const auto X_LS =
    Transform<Link<5>, ForceSensor>::translation_xyz(0.01, 0, 0.112).rotated_z(0.4).rotated_x(0.9);
constexpr Xyz<double> centre{0.02, -0.01, 0.06};

/// Drives to and fro, pitches and turns.
BaseState<double> cart(Nanoseconds now) {
  const double t = seconds<double>(now), pitch = 0.3 * std::sin(1.1 * t), rate = 0.33 * std::cos(1.1 * t),
               turning = -0.363 * std::sin(1.1 * t);
  BaseState<double> b;
  b.time = now;
  b.X_WB = Transform<World, Base>().rotated_z(0.8 * t).rotated_y(pitch);
  const Rotation<double> R = b.X_WB.axes();
  const Xyz<double> y = R.y, up{R.x.z, R.y.z, R.z.z};
  // The pitch is about the y axis, which turns with the yaw of 0.8 rad/s about the world's z.
  b.V_WB_B.angular = Xyz<double>{0, rate, 0} + 0.8 * up;
  b.A_WB_B.angular = Xyz<double>{0, turning, 0} + 0.8 * cross(up, Xyz<double>{0, rate, 0});
  b.A_WB_B.linear = R.transpose() * Xyz<double>(2 * std::sin(2 * t) * y);
  return b;
}
/// The acceleration, less that of free fall, of a point of the base, in its axes; written out.
Xyz<double> felt_at(const BaseState<double>& b, const Xyz<double>& p) {
  const Rotation<double> R = b.X_WB.axes();
  return b.A_WB_B.linear + g * Xyz<double>{R.x.z, R.y.z, R.z.z} + cross(b.A_WB_B.angular, p) +
         cross(b.V_WB_B.angular, cross(b.V_WB_B.angular, p));
}
template <class M, class Touch>
auto scene_of(const M& model, const Touch& touch) {
  return Cycle(
      by_position(
          model,
          {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4}),
      touch, SkinJointControl{} + GravityControl{});
}

struct Course {
  double moved = 0;  ///< largest way of a joint [rad]
  Status said;
};
/// Eight seconds on the cart; `feel(input, base, pushed)` fills what the sensor reads.
template <class Scene, class Feel>
Course ride(const Scene& scene, const Feel& feel, bool pushes = false) {
  auto memory = scene.start({0ns, home, {}});
  JointPosition<6> at = home;
  Course out;
  for (int k = 1; k <= 1000; ++k) {
    typename Scene::Input input;
    input.now = input.measured.time = k * 8ms;
    input.measured.q = at;
    const auto base = cart(input.now);
    if constexpr (requires { input.base; }) input.base = base;
    [[maybe_unused]] const auto kept = feel(input, base, at, pushes && k > 500 && k < 550);
    const auto sent = scene.step(memory, input);
    at = sent.command.position;
    out.said |= sent.status;
    for (std::size_t i = 0; i < 6; ++i) out.moved = std::max(out.moved, std::abs(at[i] - home[i]));
  }
  return out;
}
/// What a wrist sensor reads of its tool, and of 15 N upwards along the base.
constexpr auto wrench = [](auto& input, const auto& base, const auto& q, bool pushed) {
  const auto X_BS = link_poses(ur5::Model{}, q).template get<5>() * X_LS;
  const Rotation<double> R = X_BS.axes();
  const Xyz<double> pull = -tool_mass * felt_at(base, X_BS.origin() + R * centre);
  const Xyz<double> f = R.transpose() * Xyz<double>(pull + Xyz<double>{0, 0, pushed ? 15.0 : 0.0}),
                    m = cross(centre, R.transpose() * pull);
  auto sample = std::make_unique<WrenchSample>(WrenchSample{input.now, {f.x, f.y, f.z}, {m.x, m.y, m.z}});
  input.sensed.wrenches = {sample.get(), 1};
  return sample;
};
/// Of motors that hold the arm.
constexpr auto motors = [](auto& input, const auto& base, const auto& q, bool) {
  const BaseMotion<double> moves{base.V_WB_B.angular, base.A_WB_B.angular, felt_at(base, {0, 0, 0})};
  input.sensed.motor_torque = inverse_dynamics_on(
      ur5::Model{}, JointAngles<ur5::Model, double>(ur5::Model{}, q), {}, JointAcceleration<6>{}, moves);
  return 0;
};
/// Of a robot that takes its base to stand: what it does not know is a contact to it.
constexpr auto told = [](auto& input, const auto& base, const auto& q, bool pushed) {
  motors(input, base, q, pushed);
  input.sensed.motor_torque = gravity_torque(ur5::Model{}, q) - input.sensed.motor_torque;
  return 0;
};

}  // namespace

TEST_CASE("Moving base: a wrist sensor feels no touch of the tool that it carries around") {
  WristSensorSettings<5> s{.X_LS = X_LS, .mass = tool_mass, .centre = centre};
  s.force = EventGate<>::dead_band(0.5), s.moment = EventGate<>::dead_band(0.05);
  const OnMovingBase moving{ur5::Model{}};
  const auto knows = scene_of(moving, wrist_sensor<5>(moving, s));
  const auto still = scene_of(ur5::Model{}, wrist_sensor<5>(ur5::Model{}, s));
  CHECK(ride(knows, wrench).moved < 1e-12);
  CHECK(ride(still, wrench).moved > 0.1);
  CHECK(ride(knows, wrench, true).moved > 0.05);
}

TEST_CASE("Moving base: motors, and a robot that tells contacts, feel no touch of the base's motion") {
  const OnMovingBase moving{ur5::Model{}};
  using Moving = std::remove_const_t<decltype(moving)>;
  const auto gate = EventGate<>::dead_band(0.5);
  const auto knows = scene_of(moving, MotorTouch<Moving>(moving, {.gates = same_gate(moving, gate)}));
  const auto still =
      scene_of(ur5::Model{}, MotorTouch<ur5::Model>(ur5::Model{}, {.gates = same_gate(ur5::Model{}, gate)}));
  CHECK(ride(knows, motors).moved < 1e-12);
  CHECK(ride(still, motors).moved > 0.1);
  const auto robot = scene_of(moving, RobotTouch<Moving>(moving, {.gates = same_gate(moving, gate)}));
  const auto blind =
      scene_of(ur5::Model{}, RobotTouch<ur5::Model>(ur5::Model{}, {.gates = same_gate(ur5::Model{}, gate)}));
  CHECK(ride(robot, told).moved < 1e-12);
  CHECK(ride(blind, told).moved > 0.1);
}

TEST_CASE("Moving base: what a wrist sensor feels of a push is what it feels at rest") {
  WristSensorSettings<5> s{.X_LS = X_LS, .mass = tool_mass, .centre = centre};
  s.force = EventGate<>(), s.moment = EventGate<>();
  const OnMovingBase moving{ur5::Model{}};
  const auto scene = scene_of(moving, wrist_sensor<5>(moving, s));
  auto memory = scene.start({0ns, home, {}});
  double worst = 0;
  for (int k = 1; k <= 400; ++k) {
    decltype(scene)::Input input;
    input.now = input.measured.time = k * 8ms;
    input.measured.q = home;
    input.base = cart(input.now);
    [[maybe_unused]] const auto kept = wrench(input, input.base, home, true);
    static_cast<void>(scene.step(memory, input));
    const auto w = scene.skin().wrenches(memory.skin);
    const Rotation<double> R = link_poses(ur5::Model{}, home).get<5>().axes();
    const Xyz<double> f = R * Xyz<double>{w.data[0][0], w.data[0][1], w.data[0][2]};
    worst = std::max(worst, norm(Xyz<double>(f - Xyz<double>{0, 0, 15})));
  }
  CHECK(worst < 1e-9);
}
