// Stiff contacts of an arm that feels by a wrist sensor, or by its motors.
//
// Promise: a tool behind a wrist sensor rests on a table with the felt mass that the check of stiff
// contacts asks for
// Tried: UR5, 5 kN/m, 8 ms of delay, led against it by 20 N: swings by less than 0.5 N; as it is, without
// force lead, by more than 5 N, and such a scene is refused

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <memory>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/simulated_joints.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const ur5::Model model;
const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
const auto X_LS = Transform<Link<5>, ForceSensor>::translation_xyz(0, 0, 0.1);

auto sensor(double gain = 1) {
  return wrist_sensor<5>(
      model, {.X_LS = X_LS, .force = EventGate<>(), .moment = EventGate<>(), .gain = gain, .ramp = 8ms});
}
RobotConfiguration<6> configuration(double heavier = 1) {
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(50.0), .period = 8ms, .delay = 8ms};
  c.virtual_damping = 4 / heavier;
  c.viscous_friction = (1 / heavier) * JointTorque<6>{20, 20, 10, 2, 1, 0.5};
  c.virtual_inertia = {0, 0, 0, 0.1, 0.1, 0.1};  // of the wrist, whose flange alone weighs 4 g on its edge
  return c;
}
auto arm() {
  return by_position(model, configuration());
}
Transform<Base, ForceSensor> sensor_at(const JointPosition<6>& q) {
  return Poses<ur5::Model, all_links(6)>(model, JointAngles<ur5::Model, double>(model, q)).get<5>() * X_LS;
}

/// The greatest change of the force on a wall in the last second: a hand leads the tool against it with 20 N.
template <class Scene>
double swing_on_wall(const Scene& scene, double stiffness) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, 0.008, 0, std::to_array(home.data));
  scene.start(*memory, {0ns, home, {}});
  const Xyz<double> start = sensor_at(home).origin();
  double low = 1e9, high = -1e9;
  for (int k = 1; k <= 1000; ++k) {
    std::array<WrenchSample, 4> samples;
    for (std::size_t j = 0; j < 4; ++j) {
      const Nanoseconds t = 8ms * (k - 1) + 2ms * (long(j) + 1);
      joints.advance(seconds<double>(t));
      const auto X = sensor_at(JointPosition<6>(joints.q()));
      const double into = start.z - 0.005 - X.origin().z;  // the table is 5 mm below
      const double wall = std::max(0.0, stiffness * into);
      const Xyz<double> f = X.axes().transpose() * Xyz<double>{0, 0, wall - 20};
      samples[j] = {t, {f.x, f.y, f.z}, {0, 0, 0}};
      if (k > 875) low = std::min(low, wall), high = std::max(high, wall);
    }
    typename Scene::Input input;
    input.now = input.measured.time = 8ms * k;
    input.measured.q = JointPosition<6>(joints.q());
    input.sensed.wrenches = samples;
    const auto out = scene.step(*memory, input);
    REQUIRE(out.command.valid);
    joints.command(0.008 * k, std::to_array(out.command.position.data));
  }
  CHECK(high > 10);  // it leans on the table
  return high - low;
}

}  // namespace

TEST_CASE(
    "StiffestContact: a tool behind a wrist sensor rests on a table with the felt mass that the check asks "
    "for") {
  const StiffestContact contact{.stiffness = 5e3, .skin_delay = 2ms, .poses = 4};
  const double needed = contact.heavier(arm(), sensor());
  MESSAGE(needed << " times heavier");
  CHECK(needed > 2);
  const auto law = SkinJointControl{} + GravityControl{};
  CHECK_THROWS_AS(Cycle(by_position(model, configuration(), contact), sensor(), law), ConfigurationError);
  const Cycle heavy(by_position(model, configuration(needed), contact), sensor(1 / needed), law);
  CHECK(swing_on_wall(heavy, 5e3) < 0.5);
  auto late = configuration();
  late.force_lead = 0ns;
  CHECK(swing_on_wall(Cycle(by_position(model, late), sensor(), law), 5e3) > 5);
}

TEST_CASE("StiffestContact: looks at the contacts of all sources of touch") {
  const StiffestContact contact{.stiffness = 2e4, .skin_delay = 2ms, .poses = 2};
  const auto robot = arm();
  const std::vector<PlacedCell<0>> cells{cell_at<0>(1, {0, 0.06, 0.05}, {0, 1, 0})};
  const auto skin = open_skin(Patch<0, 1>(cells, open_gains));
  const double of_skin = contact.heavier(robot, skin), of_sensor = contact.heavier(robot, sensor());
  REQUIRE(of_sensor > 1.5 * of_skin);  // a cell on the shoulder moves little
  CHECK(contact.heavier(robot, skin + sensor()) >= 0.99 * of_sensor);
  CHECK(contact.heavier(robot, sensor(3)) > 1.5 * of_sensor);
  const auto motors = [&](double gain) {
    return MotorTouch(model, {.gates = same_gate(model, EventGate<>(1, 1, 1)), .gain = gain});
  };
  const double of_motors = contact.heavier(robot, motors(1));
  CHECK(of_motors > 2);
  CHECK(contact.heavier(robot, skin + motors(3)) > 1.5 * of_motors);
}
