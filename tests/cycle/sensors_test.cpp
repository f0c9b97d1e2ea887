// Scenes whose touch comes from a wrist sensor, from the motors, or from several sources together.
#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/passivity/energy_tank.hpp"
#include "skinctl/passivity/passivity_observer.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/touch_sum.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "tests/support/mujoco_plant.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const ur5::Model model;
const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

/// Three cells on the forearm.
auto forearm_skin() {
  const std::vector<PlacedCell<2>> cells{cell_at<2>(1, {-0.2, 0.04, 0.02}, {0, 1, 0}),
                                         cell_at<2>(2, {-0.2, -0.04, 0.02}, {0, -1, 0}),
                                         cell_at<2>(3, {-0.25, 0, 0.06}, {0, 0, 1})};
  return open_skin(Patch<2, 3>(cells, open_gains));
}
WristSensorSettings<5> open_sensor() {
  return {.X_LS = Transform<Link<5>, ForceSensor>::translation_xyz(0, 0, 0.1),
          .force = EventGate<>(),
          .moment = EventGate<>()};
}
auto open_motors(double gain = 1) {
  return MotorTouch(model,
                    {.observer = {.rate = 100}, .gates = same_gate(model, EventGate<>()), .gain = gain});
}
CellSample pressed(Nanoseconds time, std::uint32_t cell, double newtons) {
  CellSample s;
  s.time = time;
  s.cell = cell;
  for (float& f : s.force) f = static_cast<float>(newtons / (3 * newtons_per_unit));
  return s;
}

}  // namespace

static_assert(sizeof(CycleInput<6>) ==
                  sizeof(Nanoseconds) + sizeof(State<6>) + sizeof(std::span<const int>) + 8 + sizeof(Status),
              "sensors and goals that a scene does not have cost its input nothing");

TEST_CASE("TouchSum: laws see the torques of skin and wrist sensor, contacts are of both") {
  const auto both = forearm_skin() + wrist_sensor<5>(model, open_sensor());
  using Both = std::remove_cvref_t<decltype(both)>;
  static_assert(Both::links == (link_bit<2> | link_bit<5>));
  auto memory = both.start(0ns);
  auto alone = forearm_skin().start(0ns);
  auto wrist = wrist_sensor<5>(model, open_sensor()).start(0ns);
  const CellSample cells[] = {pressed(4ms, 1, 20), pressed(4ms, 2, 0), pressed(4ms, 3, 0)};
  const WrenchSample wrenches[] = {{4ms, {3, -4, 5}, {0.1, 0.2, 0.3}}};
  const State<6> at{4ms, home, {}};
  Both::Touch means[3];
  CHECK_FALSE(both.receive(memory, cells, {wrenches}, at, 0ns, 6ms, 3, means).any());
  decltype(forearm_skin())::Touch of_skin[3];
  forearm_skin().receive(alone, cells, 0ns, 6ms, 3, of_skin);
  LinkWrenches<ur5::Model, link_bit<5>> of_wrist[3];
  wrist_sensor<5>(model, open_sensor()).receive(wrist, {}, {wrenches}, at, 0ns, 6ms, 3, of_wrist);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto sum = skin_torque(model, home, total_of(means[j]));
    const auto a = skin_torque(model, home, of_skin[j].total()), b = skin_torque(model, home, of_wrist[j]);
    for (std::size_t i = 0; i < 6; ++i) CHECK(sum[i] == a[i] + b[i]);
  }
  const auto contacts = contacts_of(model, home, contact_part(both.touch(memory)));
  CHECK(contacts.count == 2);
  double force = 0;
  for (const auto& c : contacts) force += c.force;
  CHECK(force == doctest::Approx(20 + std::sqrt(50.0)).epsilon(1e-4));
  // Samples of cells that the skin does not have are reported, by the skin.
  const CellSample strange[] = {pressed(8ms, 77, 20)};
  CHECK(both.receive(memory, strange, {}, at, 6ms, 8ms, 3, means).has(Reason::sample_unknown));
}

TEST_CASE("MotorTouch: beside a skin a push counts once, and one off the skin is felt") {
  const auto both = forearm_skin() + open_motors();
  using Both = std::remove_cvref_t<decltype(both)>;
  // A brake holds the arm; its motors feel what pushes on it.
  const auto G = gravity_torque(model, home);
  const auto run = [&](double on_skin, const JointTorque<6>& truth) {
    auto memory = both.start(0ns);
    Both::Wrenches mean[1];
    for (int k = 1; k <= 100; ++k) {
      const Nanoseconds now = 4ms * k;
      const CellSample cells[] = {pressed(now, 1, on_skin), pressed(now, 2, 0), pressed(now, 3, 0)};
      MotorInput<6> input;
      for (std::size_t i = 0; i < 6; ++i) input.motor_torque[i] = G[i] - truth[i];
      both.receive(memory, cells, input, State<6>{now, home, {}}, now - 4ms, now, 1, mean);
    }
    return skin_torque(model, home, total_of(mean[0]));
  };
  auto memory = forearm_skin().start(0ns);
  const CellSample press[] = {pressed(4ms, 1, 30), pressed(4ms, 2, 0), pressed(4ms, 3, 0)};
  decltype(forearm_skin())::Wrenches of_skin[1];
  forearm_skin().receive(memory, press, 0ns, 4ms, 1, of_skin);
  const auto felt = skin_torque(model, home, forearm_skin().wrenches(memory));
  double largest = 0;
  for (std::size_t i = 0; i < 6; ++i) largest = std::max(largest, std::abs(felt[i]));
  REQUIRE(largest > 1);
  const auto same = [&](const JointTorque<6>& a, const JointTorque<6>& b) {
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(a[i] - b[i]) <= 1e-3 * largest);
  };
  same(run(30, felt), felt);                     // felt by both
  same(run(30, {}), felt);                       // an own sum of the motors finds nothing
  same(run(30, 2.0 * felt), 2.0 * felt);         // the skin understates it
  same(run(30, 0.5 * felt), felt);               // the skin overstates it
  same(run(0, felt), felt);                      // off the skin
  same(run(30, -1.0 * felt), JointTorque<6>{});  // two opposite pushes
}

TEST_CASE("MotorTouch, TouchSources: a state that is missing lets go, one that is not finite is refused") {
  const auto motors = open_motors();
  auto memory = motors.start(0ns);
  const auto G = gravity_torque(model, home);
  MotorInput<6> input{G};
  input.motor_torque[1] -= 5;
  JointTouch<ur5::Model> mean[2];
  Status all;
  MotorInput<6> first{G};
  motors.receive(memory, {}, first, State<6>{2ms, home, {}}, 0ns, 2ms, 2, mean);
  for (int k = 2; k <= 100; ++k)
    all |= motors.receive(memory, {}, input, State<6>{2ms * k, home, {}}, 2ms * (k - 1), 2ms * k, 2, mean);
  CHECK_FALSE(all.any());
  CHECK(mean[1].torque[1] == doctest::Approx(5).epsilon(1e-3));
  auto wrong = input;
  wrong.motor_torque[3] = std::nan("");
  CHECK(motors.receive(memory, {}, wrong, State<6>{202ms, home, {}}, 200ms, 202ms, 2, mean) ==
        Status(Reason::sample_not_finite));
  CHECK(mean[1].torque[1] == doctest::Approx(5).epsilon(1e-3));
  // Beside a skin too: TouchSources hands on the reason, and the skin's part is finite.
  const auto both = forearm_skin() + motors;
  auto beside = both.start(0ns);
  std::remove_cvref_t<decltype(both)>::Wrenches sums[1];
  for (int k = 1; k <= 3; ++k)
    CHECK(both.receive(beside, {}, k < 3 ? input : wrong, State<6>{4ms * k, home, {}}, 4ms * (k - 1), 4ms * k,
                       1, sums)
              .has(Reason::sample_not_finite) == (k == 3));
  for (const double tau : skin_torque(model, home, total_of(sums[0]))) CHECK(std::isfinite(tau));
  // The same state again and again: held for 50 ms, gone after 100 ms.
  const State<6> old{200ms, home, {}};
  CHECK_FALSE(motors.receive(memory, {}, input, old, 202ms, 248ms, 2, mean).any());
  CHECK(mean[1].torque[1] == doctest::Approx(5).epsilon(1e-3));
  CHECK(motors.receive(memory, {}, input, old, 248ms, 310ms, 2, mean) == Status(Reason::sample_stale));
  CHECK(motors.receive(memory, {}, input, old, 310ms, 312ms, 2, mean) == Status(Reason::sample_stale));
  CHECK(mean[1].torque[1] == 0);
}

TEST_CASE("MotorTouch: an arm without any tactile sensor is led by its forearm, and rests untouched") {
  const std::vector<double> q(home.data, home.data + 6);
  std::array<double, 6> rotor{}, ones{};
  rotor.fill(1), ones.fill(1);
  const MotorTouch motors(
      model, {.observer = {.rate = 50, .rotors = RotorInertia<6>(rotor, ones), .motors = MotorSampling::mean},
              .gates = same_gate(model, EventGate<>(1.5, 1.0, 1.0))});
  const Cycle scene(
      by_position(
          model,
          {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .lag = 8ms, .virtual_damping = 4}),
      motors, SkinJointControl{} + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(scene)>;
  oracle::MujocoPlant plant(ur5_robot().table, q, {.rotor = std::vector<double>(6, 1.0)});
  const auto memory = std::make_unique<Scene::Memory>();
  scene.start(*memory, {0ns, home, {}});
  Recording<Scene> recording(std::size_t(1) << 20);
  recording.start({0ns, home, {}});
  const double at[3] = {-0.3, 0, 0}, none[3] = {};
  double work = 0, before = 0, fastest_after = 0, resting = 0;
  double place[3], velocity[3], axes[9];
  for (int k = 1; k <= 625; ++k) {
    const double t = 0.008 * k;
    const double force[3] = {0, 25, -25};
    const bool pushed = t > 1 && t < 2;
    JointTorque<6> motor;
    for (int j = 0; j < 40; ++j) {
      plant.step(2, at, pushed ? force : none);
      for (std::size_t i = 0; i < 6; ++i) motor[i] += plant.motor_torque()[i] / 40;
      plant.point(2, at, place, velocity, axes);
      if (pushed) work += 2e-4 * (force[1] * velocity[1] + force[2] * velocity[2]);
    }
    Scene::Input input;
    input.now = input.measured.time = 8ms * k;
    for (std::size_t i = 0; i < 6; ++i) {
      input.measured.q[i] = plant.q()[i];
      input.measured.dq[i] = plant.dq()[i];
      input.sensed.motor_torque[i] = motor[i];
      if (t <= 1) before = std::max(before, std::abs(plant.q()[i] - home[i]));
      if (t > 4.8) fastest_after = std::max(fastest_after, std::abs(plant.dq()[i]));
      if (t > 4.8) resting = std::max(resting, std::abs(plant.q()[i] - home[i]));
    }
    const auto out = scene.step(*memory, input);
    recording.add(input, out.planned);
    REQUIRE(out.command.valid);
    plant.command(out.command.position.data);
  }
  CHECK(before <= 1e-6);
  CHECK(work > 1);  // the hand led it
  CHECK(resting > 0.1);
  CHECK(fastest_after <= 1e-3);
  const auto replayed = replay(scene, recording);
  CHECK(replayed.cycles == 625);
  CHECK(replayed.different == 0);
}

TEST_CASE("Cycle: skin, wrist sensor and motors in one scene, with tank and ledger: each gives way") {
  const auto touch = forearm_skin() + wrist_sensor<5>(model, open_sensor()) + open_motors();
  const Cycle scene = Cycle(
      by_position(
          model,
          {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4},
          EnergyTank<>({.start = 1, .max = 1}), PassivityObserver<>({.start = 1, .max = 1})),
      touch, SkinJointControl{} + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(scene)>;
  enum Source { nothing, cells, wrist, motors };
  const auto moved = [&](Source source) {
    const auto memory = std::make_unique<Scene::Memory>();
    SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, 0.008, 0, std::to_array(home.data));
    scene.start(*memory, {0ns, home, {}});
    Status all;
    for (int k = 1; k <= 60; ++k) {
      joints.advance(0.008 * k);
      Scene::Input input;
      input.now = input.measured.time = 8ms * k;
      for (std::size_t i = 0; i < 6; ++i) input.measured.q[i] = joints.q()[i];
      const CellSample skin[] = {pressed(input.now, 1, source == cells ? 20 : 0), pressed(input.now, 2, 0),
                                 pressed(input.now, 3, 0)};
      const WrenchSample sensor[] = {{input.now, {source == wrist ? 20.0 : 0.0, 0, 0}, {0, 0, 0}}};
      input.samples = skin;
      input.sensed.wrenches = sensor;
      // dq is left at 0: as if a brake held the joints, the motors carry gravity.
      input.sensed.motor_torque = gravity_torque(model, input.measured.q);
      if (source == motors) input.sensed.motor_torque[0] -= 10;
      const auto out = scene.step(*memory, input);
      REQUIRE(out.command.valid);
      all |= out.status;
      joints.command(0.008 * k, std::to_array(out.command.position.data));
    }
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i) most = std::max(most, std::abs(joints.q()[i] - home[i]));
    CHECK_FALSE(all.has(Reason::sample_stale));
    CHECK_FALSE(all.has(Reason::sample_unknown));
    return most;
  };
  CHECK(moved(nothing) == 0);
  CHECK(moved(cells) > 0.02);
  CHECK(moved(wrist) > 0.02);
  CHECK(moved(motors) > 0.02);
}

TEST_CASE("Cycle: a garbled torque of the motors leads nobody: beyond the joint's it is refused and named") {
  // Of a single sample; where the greatest torque is not declared, 1000 N m lead by half a radian.
  const auto led = [](double garbled, const std::array<double, 6>& most, Nanoseconds period, Status& all) {
    auto motors = MotorTouchSettings<ur5::Model>{.gates = same_gate(model, EventGate<>::dead_band(3))};
    motors.max_torque = most;
    const Cycle scene(by_velocity(model, {.limits = limits_of<ur5::Description>(15.0),
                                          .period = period,
                                          .delay = period,
                                          .virtual_damping = 4}),
                      MotorTouch(model, motors), SkinJointControl{} + GravityControl{});
    using Scene = std::remove_const_t<decltype(scene)>;
    const auto memory = std::make_unique<Scene::Memory>();
    State<6> arm{0ns, home, {}};
    scene.start(*memory, arm);
    double most_moved = 0;
    for (int k = 1; k * period < 4s; ++k) {
      Scene::Input input;
      input.now = arm.time = k * period;
      input.measured = arm;
      input.sensed.motor_torque = gravity_torque(model, arm.q);
      if (k == 100) input.sensed.motor_torque[1] = garbled;
      const auto out = scene.step(*memory, input);
      REQUIRE(out.command.valid);
      all |= out.status;
      arm.dq = out.command.velocity;
      for (std::size_t i = 0; i < 6; ++i) {
        arm.q[i] += arm.dq[i] * seconds<double>(period);
        most_moved = std::max(most_moved, std::abs(arm.q[i] - home[i]));
      }
    }
    return most_moved;
  };
  for (const Nanoseconds period : {8ms, 1ms})
    for (const double garbled : {1e3, -1e3, 1e5, 1e12, 1e38, -1e150, 1e300}) {
      CAPTURE(period.count());
      CAPTURE(garbled);
      Status declared, undeclared;
      CHECK(led(garbled, ur5::Description::max_torque, period, declared) < 1e-3);
      CHECK(declared.has(Reason::sample_out_of_range));
      const double by_default = led(garbled, MotorTouchSettings<ur5::Model>{}.max_torque, period, undeclared);
      CHECK(undeclared.has(Reason::sample_out_of_range) == (std::abs(garbled) > 1e4));
      if (std::abs(garbled) > 1e4) CHECK(by_default < 1e-3);
    }
}
