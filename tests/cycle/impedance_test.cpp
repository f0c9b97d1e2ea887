// Promise: springs that a push deflects are no gap, and the arm gives way beside as configured
// Tried: a UR5 on springs of 500 N m/rad with its own dynamics: 40 and 60 N m that come within 8 ms to
// 0.5 s, held and yielded to, deflect 80 and 120 mrad, of which at most a quarter is unexplained for a
// while; told wrong by a fifth 16 mrad stay, within the dead band; commands are those of a robot that
// nothing deflects, to 1e-9; the same arm by position is displaced

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robot/spring.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/joint_touch.hpp"
#include "skinctl/testing/impedance_plant.hpp"

using namespace skinctl;
using testing::ImpedancePlant;

namespace {

const JointPosition<6> pose{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
constexpr double period = 0.008;

// A touch that tells joint torques as a test says.
struct Told {
  using scalar = double;
  using Wrenches = JointTouch<ur5::Model>;
  struct Sensed {
    JointTorque<6> told;
  };
  using Memory = Sensed;
  Memory start(Nanoseconds) const noexcept { return {}; }
  Status receive(Memory& m, std::span<const CellSample>, const Sensed& sensed, const State<6>&, Nanoseconds,
                 Nanoseconds, std::size_t parts, Wrenches* means) const noexcept {
    m = sensed;
    for (std::size_t j = 0; j < parts; ++j) means[j].torque = m.told;
    return {};
  }
  Wrenches wrenches(const Memory& m) const noexcept { return {m.told}; }
};

// Gives way to a share of the touch, and holds the pose by a spring.
struct GivesWay : StatelessLaw<GivesWay> {
  static constexpr Needs needs{.touch = true};
  double share = 1, spring = 0;
  template <class K>
  JointTorque<6> torque(const K& known) const noexcept {
    auto tau = share * known.touch().torque;
    for (std::size_t i = 0; i < 6; ++i)
      tau[i] += spring * (pose[i] - known.q()[i]) - 0.2 * spring * known.dq()[i];
    return tau;
  }
};

RobotConfiguration<6> configuration() {
  // Half of the period: the robot goes to each position within one.
  return {.limits = limits_of<ur5::Description>(20.0),
          .period = 8ms,
          .delay = 16ms,
          .stiffness = JointTorque<6>::constant(500),
          .spring_lag = 100ms,  // 1.4 sqrt(2.7 / 500) of joint 0
          .virtual_damping = 4,
          .virtual_inertia = JointTorque<6>::constant(1)};
}
RobotConfiguration<6> without_springs() {
  auto c = configuration();
  c.stiffness.reset();
  c.spring_lag.reset();
  return c;
}
testing::ImpedanceTruth<6> truth() {
  return {.stiffness = JointTorque<6>::constant(500),
          .rotors = JointTorque<6>::constant(0.15),
          .delay = 0.012,
          .period = period};
}

template <class Robot>
struct Run {
  using Scene =
      decltype(Cycle(std::declval<Robot>(), Told{}, GivesWay{} + GravityControl{}).with(GuardSettings<6>{}));
  Scene scene;
  ImpedancePlant<ur5::Model> plant{ur5::Model{}, truth(), pose};
  typename Scene::Memory memory;
  typename Scene::Input input;
  typename Scene::Output out{};
  Status said;
  double told = 1;  // share of the push that the touch tells
  JointTorque<6> told_more;
  bool feeds = true;  // whether the robot takes the torque beside its positions
  double fastest = 0, hardest = 0, steepest = 0, worst = 0;
  JointTorque<6> last_torque;

  Run(const Robot& robot, const GivesWay& law, const GuardSettings<6>& guard = {})
      : scene(Cycle(robot, Told{}, law + GravityControl{}).with(guard)) {
    scene.start(memory, {0ns, pose, {}});
  }
  void step(const JointTorque<6>& push) {
    plant.push(push);
    plant.run(period);
    input.now += 8ms;
    input.measured = {input.now, plant.q(), plant.dq()};
    input.sensed.told = told * push + told_more;
    out = scene.step(memory, input);
    input.request = CycleRequest::none;
    said |= out.status;
    ImpedanceCommand<6> sent;
    sent.position = out.command.position;
    if constexpr (std::is_same_v<decltype(out.command), ImpedanceCommand<6>>)
      sent.torque = feeds ? out.command.torque : JointTorque<6>{};
    if (out.command.valid) plant.command(sent);
    for (std::size_t i = 0; i < 6; ++i) {
      fastest = std::max(fastest, std::abs(out.planned.velocity[i]));
      hardest = std::max(hardest, std::abs(sent.torque[i]) / ur5::Description::max_torque[i]);
      steepest = std::max(
          steepest, std::abs(sent.torque[i] - last_torque[i]) / ur5::Description::max_torque[i] / period);
    }
    last_torque = sent.torque;
    for (const double r : memory.robot.group().residual) worst = std::max(worst, std::abs(r));
  }
  // A push on joint 0 that rises and falls within `rise` seconds.
  void push(double torque, double seconds_, double rise = 0.1) {
    const int cycles = static_cast<int>(std::lround(seconds_ / period));
    for (int k = 0; k < cycles; ++k) {
      const double t = k * period, left = seconds_ - t;
      JointTorque<6> tau;
      tau[0] = torque * std::min({1.0, (t + period) / rise, left / rise});
      step(tau);
    }
  }
  void hold(double torque, double seconds_) {
    JointTorque<6> tau;
    tau[0] = torque;
    for (int k = 0; k < std::lround(seconds_ / period); ++k) step(tau);
  }
  double deflection() const { return plant.q()[0] - out.command.position[0]; }
  double residual() const { return memory.robot.group().residual[0]; }
};
template <class Robot>
Run(const Robot&, const GivesWay&, const GuardSettings<6>& = {}) -> Run<Robot>;

auto arm() {
  return by_impedance(ur5::Model{}, configuration());
}

}  // namespace

TEST_CASE("by impedance: a push deflects the springs and opens no gap") {
  Run run(arm(), {{}, 0, 400});
  for (const double rise : {0.0, 1.0}) {
    CAPTURE(rise);
    for (int k = 0; k < 100; ++k) run.hold(40 * std::min(1.0, rise == 0 ? 1 : k * period / rise), period);
    run.hold(40, 2);
    CHECK(run.deflection() == doctest::Approx(0.080).epsilon(0.01));
    CHECK(std::abs(run.residual()) < 1e-3);
    CHECK(std::abs(run.out.command.position[0] - pose[0]) < 2e-3);
    run.hold(0, 2);
    CHECK(std::abs(run.deflection()) < 1e-3);
    CHECK_FALSE(run.said.has(Reason::displaced));
    CHECK_FALSE(run.said.has(Reason::blocked));
  }
}

TEST_CASE("by impedance: pushes of all speeds, held and yielded to, open no gap") {
  for (const double rise : {0.008, 0.05, 0.1, 0.2, 0.5})
    for (const double torque : {40.0, 60.0})
      for (const GivesWay law : {GivesWay{{}, 0, 400}, GivesWay{{}, 1, 400}, GivesWay{{}, 1, 0}}) {
        CAPTURE(rise);
        CAPTURE(torque);
        CAPTURE(law.share);
        CAPTURE(law.spring);
        auto c = configuration();
        if (law.spring == 0) c.virtual_damping = 20;
        Run run(by_impedance(ur5::Model{}, c), law);
        run.push(torque, 2, rise);
        run.hold(0, 2);
        CHECK_FALSE(run.said.has(Reason::displaced));
        CHECK_FALSE(run.said.has(Reason::blocked));
        CHECK(run.worst < 0.3 * torque / 500);
        CHECK(std::abs(run.deflection()) < 1e-3);
      }
}

TEST_CASE("by position the same push is a gap of the same arm") {
  const auto c = without_springs();
  Run run(by_position(ur5::Model{}, c), {{}, 0, 400});
  run.push(40, 3, 0.5);
  CHECK(std::abs(run.memory.robot.group().gap[0]) > 0.02);
}

TEST_CASE("by impedance: a push told wrong by a fifth stays within the dead band") {
  for (const double told : {0.8, 1.2}) {
    CAPTURE(told);
    auto c = configuration();
    c.dead_band = JointPosition<6>::constant(0.05);
    Run run(by_impedance(ur5::Model{}, c), {{}, 0, 400});
    run.told = told;
    run.hold(40, 3);
    CHECK(run.residual() == doctest::Approx((1 - told) * 0.080).epsilon(0.05));
    CHECK(std::abs(run.out.command.position[0] - pose[0]) < 2e-3);
    run.hold(0, 2);
    CHECK_FALSE(run.said.has(Reason::displaced));
    CHECK_FALSE(run.said.has(Reason::blocked));
    CHECK(std::abs(run.residual()) < 1e-3);
  }
}

TEST_CASE("by impedance: the arm gives way as the virtual robot does, and comes to rest") {
  Run run(arm(), {});
  run.push(10, 0.6);
  CHECK(run.plant.q()[0] - pose[0] > 0.2);
  run.hold(0, 3);
  CHECK(std::abs(run.plant.dq()[0]) < 1e-4);
  CHECK(std::abs(run.deflection()) < 1e-3);
  CHECK_FALSE(run.said.has(Reason::displaced));
  CHECK_FALSE(run.said.has(Reason::blocked));
  // What the same touch makes of a robot by position that nothing deflects.
  const auto c = without_springs();
  const auto plain = Cycle(by_position(ur5::Model{}, c), Told{}, GivesWay{} + GravityControl{});
  auto memory = plain.start({0ns, pose, {}});
  typename decltype(plain)::Input input;
  input.measured.q = pose;
  Run again(arm(), {});
  for (int k = 0; k < 450; ++k) {
    const double t = k * period;
    input.now = input.measured.time = (k + 1) * 8ms;
    input.sensed.told[0] = t < 0.6 ? 10 * std::min({1.0, (t + period) / 0.1, (0.6 - t) / 0.1}) : 0;
    again.step(input.sensed.told);
    const auto out = plain.step(memory, input);
    input.measured.q = memory.robot.group().under_way.reached;
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(std::abs(out.command.position[i] - again.out.command.position[i]) < 1e-9);
  }
}

TEST_CASE("by impedance: the torque beside the positions keeps springs from bending for accelerations") {
  double bent[2];
  for (const bool fed : {false, true}) {
    Run run(arm(), {});
    run.feeds = fed;
    double& worst = bent[fed ? 1 : 0] = 0;
    run.told = 1;
    for (int k = 0; k < 200; ++k) {
      run.told_more[0] = 20 * std::sin(2 * k * period);  // felt, but nobody pushes
      run.step({});
      for (std::size_t i = 0; i < 6; ++i)
        worst = std::max(worst, std::abs(run.plant.q()[i] - run.plant.reference()[i]));
    }
    CHECK_FALSE(run.said.has(Reason::torque_limited));
  }
  CAPTURE(bent[0]);
  CHECK(bent[1] < 0.3 * bent[0]);
}

TEST_CASE("by impedance: limits of position, speed, torque and its rate hold") {
  auto c = configuration();
  auto v = c.limits.values();
  v.lower[0] = pose[0] - 0.3, v.upper[0] = pose[0] + 0.3;
  v.torque[0] = 60;
  c.limits = JointLimits<6>(v);
  for (const double rate : {2.0, 50.0}) {
    Run limited(by_impedance(ur5::Model{}, c), {}, GuardSettings<6>{.torque_rate = rate});
    for (int k = 0; k < 600; ++k) {
      JointTorque<6> push;
      push[0] = (k / 60) % 2 == 0 ? 50 : -50;
      limited.step(push);
      const auto& out = limited.out;
      CHECK(std::abs(out.command.position[0] - pose[0]) <= 0.3 + 1e-9);
    }
    CHECK(limited.fastest <= ur5::Description::max_velocity * (1 + 1e-9));
    CHECK(limited.hardest <= 1);
    CHECK(limited.steepest <= rate * (1 + 1e-9));
    CHECK(limited.hardest > 0.05);
    if (rate < 10) CHECK(limited.said.has(Reason::torque_limited));
    CHECK_FALSE(limited.said.has(Reason::step_limited));
  }
}

TEST_CASE("by impedance: a stop brakes, holds and lets go on") {
  Run run(arm(), {});
  run.push(10, 0.5);
  CHECK(std::abs(run.plant.dq()[0]) > 0.1);
  run.input.request = CycleRequest::stop;
  run.hold(0, 1.5);
  const double at = run.out.command.position[0];
  CHECK(run.out.status.has(Reason::stopping));
  CHECK(std::abs(run.plant.dq()[0]) < 1e-3);
  CHECK(std::abs(run.out.command.torque[0]) < 1e-9);
  run.hold(10, 1);  // it does not give way but for its springs
  CHECK(run.out.command.position[0] == at);
  CHECK(run.deflection() == doctest::Approx(10.0 / 500).epsilon(0.05));
  run.hold(0, 1);
  run.input.request = CycleRequest::resume;
  run.push(10, 0.5);
  CHECK(std::abs(run.out.command.position[0] - at) > 0.1);
}

TEST_CASE("by impedance: a guard that brakes lets the torque fade") {
  Run run(arm(), {});
  run.push(20, 0.4);
  run.input.observed = Reason::contact_force;  // any fault that stops
  const double before = run.out.command.torque[0];
  for (int k = 0; k < 60; ++k) {
    run.step({});
    CHECK(std::abs(run.last_torque[0]) <= std::max(std::abs(before), 25.0));
  }
  CHECK(run.steepest <= 50 * (1 + 1e-9));
  CHECK(std::abs(run.out.command.torque[0]) < 1e-9);
  CHECK(std::abs(run.out.planned.velocity[0]) < 1e-9);
}

TEST_CASE("by impedance: a push that is no number leaves the deflection where it was") {
  Run run(arm(), {{}, 0, 400});
  run.hold(20, 2);
  run.told_more[0] = std::numeric_limits<double>::quiet_NaN();
  run.hold(20, 0.2);
  CHECK(run.out.command.valid);
  CHECK(std::isfinite(run.out.command.position[0]));
  CHECK(run.memory.robot.group().under_way.deflection[0] == doctest::Approx(0.04));
}

TEST_CASE("by impedance: the passivity observer holds nothing for a deflection that a push pays for") {
  Run run(by_impedance(ur5::Model{}, configuration(), PassivityObserver<>({.start = 0.1, .max = 5})),
          {{}, 0, 400});
  run.hold(40, 2);
  run.hold(0, 1);
  CHECK_FALSE(run.said.has(Reason::energy_held));
}

TEST_CASE("by impedance: joints beside others") {
  const auto c = configuration();
  RobotConfiguration<3> springs{.limits = c.limits.part<JointSubset<6, 0b000111>>(),
                                .period = 8ms,
                                .delay = 16ms,
                                .stiffness = JointTorque<3>::constant(500),
                                .virtual_damping = 4,
                                .virtual_inertia = JointTorque<3>::constant(1)};
  RobotConfiguration<2> stiff{.limits = c.limits.part<JointSubset<6, 0b011000>>(),
                              .period = 8ms,
                              .delay = 16ms,
                              .virtual_damping = 4,
                              .virtual_inertia = JointTorque<2>::constant(1)};
  RobotConfiguration<1> driven{.limits = c.limits.part<JointSubset<6, 0b100000>>(), .period = 8ms};
  const auto robot = by_groups(ur5::Model{}, impedance_joints<0b000111>(springs),
                               position_joints<0b011000>(stiff), torque_joints<0b100000>(driven));
  const Cycle scene(robot, Told{}, GivesWay{{}, 0, 50} + GravityControl{});
  using Scene = std::remove_const_t<decltype(scene)>;
  static_assert(
      std::is_same_v<decltype(Scene::Output::command),
                     RobotCommand<6, double, Interface::position, Interface::torque, Interface::impedance>>);
  auto memory = scene.start({0ns, pose, {}});
  Scene::Input input;
  Status said;
  for (int k = 0; k < 300; ++k) {
    input.now = input.measured.time = (k + 1) * 8ms;
    const double push = 40 * std::min(1.0, k / 50.0);
    input.sensed.told[0] = push;
    input.measured.q = pose;
    input.measured.q[0] += push / 500;
    said |= scene.step(memory, input).status;
  }
  CHECK_FALSE(said.has(Reason::displaced));
  CHECK_FALSE(said.has(Reason::blocked));
  CHECK(std::abs(memory.robot.group<0>().residual[0]) < 1e-3);
  CHECK(std::abs(memory.robot.group<0>().command.position[0] - pose[0]) < 1e-3);
}

TEST_CASE("by impedance: springs without a stiffness, and a stiffness without springs, are refused") {
  auto c = configuration();
  const auto build = [&] { static_cast<void>(resolver_of(by_impedance(ur5::Model{}, c))); };
  CHECK_NOTHROW(build());
  for (const double k :
       {0.0, -1.0, 2e6, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    (*c.stiffness)[3] = k;
    CHECK_THROWS_WITH_AS(build(), doctest::Contains("> 0, <= 1e6 N m/rad"), ConfigurationError);
  }
  c.stiffness.reset();
  CHECK_THROWS_WITH_AS(build(), doctest::Contains("stiffness: left out"), ConfigurationError);
  c.stiffness = JointTorque<6>::constant(500);
  CHECK_THROWS_WITH_AS(static_cast<void>(resolver_of(by_position(ur5::Model{}, c))),
                       doctest::Contains("only joints by impedance"), ConfigurationError);
  c.stiffness.reset();
  c.spring_lag = 2s;
  CHECK_THROWS_WITH_AS(static_cast<void>(resolver_of(by_position(ur5::Model{}, c))),
                       doctest::Contains("spring lag = 2000, allowed: 0 to 1000 ms"), ConfigurationError);
  c.spring_lag = 20ms;
  CHECK_THROWS_WITH_AS(static_cast<void>(resolver_of(by_position(ur5::Model{}, c))),
                       doctest::Contains("only joints by impedance"), ConfigurationError);
  CHECK_THROWS_WITH_AS(static_cast<void>(by_torque(ur5::Model{}, c, FrictionUncompensated{})),
                       doctest::Contains("only joints by impedance"), ConfigurationError);
}
