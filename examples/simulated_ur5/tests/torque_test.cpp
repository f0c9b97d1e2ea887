// The arm under direct torque: energy, friction, compensation, limits, and the way back to position control.
//
// Promise: the simulated UR5 under direct torque keeps the books of energy, sticks and slides
// Tried: work becomes kinetic energy to 2 %; at rest up to the whole of its dry friction; compensated
// shares of friction within 3 % of the steady speed; back under position control without a step of speed

#include <doctest/doctest.h>

#include "examples/simulated_ur5/controller.hpp"

using namespace simulated_ur5;

namespace {

ArmConfig frictionless() {
  ArmConfig c;
  c.position_noise = c.velocity_noise = 0;
  c.drives.viscous = c.drives.coulomb = {};
  return c;
}
constexpr Nanoseconds cycle = 2'000'000;
constexpr Joints none{}, all{1, 1, 1, 1, 1, 1};

/// One cycle under torque. The power of the torque beyond gravity's compensation is added to `work`.
void push(Arm& arm, const Joints& tau, const Joints& viscous, const Joints& coulomb, double* work = nullptr) {
  arm.torque(tau, viscous, coulomb);
  REQUIRE(arm.plan(1) == Violation::none);
  for (Nanoseconds t{}; t < cycle; t += plant_step) {
    const Joints before = arm.q();
    arm.advance({});
    if (work)
      for (std::size_t i = 0; i < joint_count; ++i) *work += tau[i] * (arm.q()[i] - before[i]);
  }
  arm.measure();
}
double fastest(const Arm& arm) {
  double v = 0;
  for (const double x : arm.dq()) v = std::max(v, std::abs(x));
  return v;
}

}  // namespace

TEST_CASE("Torque: without friction the work of the torques becomes kinetic energy") {
  Arm arm(frictionless(), cycle);
  double work = 0;
  for (int i = 0; i < 150; ++i) {
    const double s = std::sin(0.05 * i);
    push(arm, {6 * s, 5, -4 * s, 0.3, 0.2 * s, 0.05}, none, none, &work);
  }
  CHECK(work > 0.5);
  CHECK(kinetic_energy(arm.q(), arm.dq(), arm.config().bodies, arm.config().drives) ==
        doctest::Approx(work).epsilon(0.02));
}

TEST_CASE("Torque: an arm whose weight is held stays, with friction and without") {
  for (const bool friction : {false, true}) {
    ArmConfig c = frictionless();
    if (friction) c.drives = JointDrives{};
    Arm arm(c, cycle);
    const Joints home = arm.q();
    for (int i = 0; i < 500; ++i) push(arm, {}, all, all);
    for (std::size_t i = 0; i < joint_count; ++i) CHECK(std::abs(arm.q()[i] - home[i]) < 1e-6);
  }
}

TEST_CASE("Torque: dry friction holds up to its size, a larger torque moves, and motion dies out") {
  ArmConfig c = frictionless();
  c.drives = JointDrives{};
  Arm arm(c, cycle);
  const double q = arm.q()[0];
  for (int i = 0; i < 200; ++i) push(arm, {5.9, 0, 0, 0, 0, 0}, none, none);
  CHECK(arm.q()[0] == doctest::Approx(q).epsilon(1e-9));
  CHECK(fastest(arm) < 1e-12);
  for (int i = 0; i < 200; ++i) push(arm, {8, 0, 0, 0, 0, 0}, none, none);
  CHECK(arm.dq()[0] > 0.1);
  double energy = kinetic_energy(arm.q(), arm.dq(), arm.config().bodies, arm.config().drives);
  bool falls = true;
  for (int i = 0; i < 500; ++i) {
    push(arm, {}, none, none);
    const double now = kinetic_energy(arm.q(), arm.dq(), arm.config().bodies, arm.config().drives);
    falls = falls && now <= energy + 1e-6;
    energy = now;
  }
  CHECK(falls);
  CHECK(fastest(arm) < 1e-9);
}

TEST_CASE("Torque: compensation takes the declared share of friction") {
  // Steady speed under a constant torque: tau = (1 - s_v) b v + (1 - s_c) c.
  for (const double share : {0.0, 0.5, 0.8}) {
    CAPTURE(share);
    ArmConfig c = frictionless();
    c.drives.viscous[5] = 1.5;
    c.drives.coulomb[5] = 1.5;
    Arm arm(c, cycle);
    Joints scale{};
    scale[5] = share;
    const double tau = 1.6 - share * 1.2;
    Joints torque{};
    torque[5] = tau;
    if (share > 0) {
      // Compensation of dry friction begins with motion: the first push is the full one.
      Joints start = torque;
      start[5] = 2;
      for (int i = 0; i < 100; ++i) push(arm, start, scale, scale);
    }
    for (int i = 0; i < 600; ++i) push(arm, torque, scale, scale);
    const double speed = (tau - (1 - share) * 1.5) / ((1 - share) * 1.5);
    CHECK(arm.dq()[5] == doctest::Approx(speed).epsilon(0.03));
  }
}

TEST_CASE("Torque: without a new command the arm brakes under position control, without a step") {
  Arm arm(frictionless(), cycle);
  for (int i = 0; i < 100; ++i) push(arm, {10, 0, 0, 0, 0, 0}, none, none);
  const double speed = arm.dq()[0];
  REQUIRE(speed > 0.2);
  double last_q = arm.q()[0], last_v = speed, jump = 0, change = 0;
  int cycles = 0;
  while (!arm.at_rest() && ++cycles < 1000) {
    arm.plan(1);
    CHECK_FALSE(arm.under_torque());
    for (Nanoseconds t{}; t < cycle; t += plant_step) {
      arm.advance({});
      jump = std::max(jump, std::abs(arm.q()[0] - last_q));
      change = std::max(change, std::abs(arm.dq()[0] - last_v));
      last_q = arm.q()[0];
      last_v = arm.dq()[0];
    }
  }
  CHECK(cycles < 200);
  CHECK(jump <= speed * 0.0005 * 1.01);
  CHECK(change <= 0.05 * speed);  // no step of speed: at most the lag's share of 20 rad/s^2
}

TEST_CASE(
    "Torque: too fast is a protective stop, no number is refused, and motors give no more than they can") {
  Arm arm(frictionless(), cycle);
  Violation v = Violation::none;
  for (int i = 0; i < 2000 && v == Violation::none; ++i) {
    arm.torque({0, 0, 0, 0, 0, 1000}, none, none);
    v = arm.plan(1);
    CHECK(arm.motor_torque()[5] <= 28);
    for (Nanoseconds t{}; t < cycle; t += plant_step) arm.advance({});
    arm.measure();
  }
  CHECK(v == Violation::speed);
  CHECK_FALSE(arm.under_torque());
  Arm other(frictionless(), cycle);
  other.torque({0, std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 0}, none, none);
  CHECK(other.plan(1) == Violation::not_a_number);
}

TEST_CASE("Torque: a program commands it from PolyScope 5.23 on, with scales from 5.25.1") {
  const std::string program =
      "def t():\n  i = 0\n  while i < 200:\n    direct_torque([9, 0, 0, 0, 0, 0]%s)\n    i = i + 1\n  end\n  "
      "stopj(4)\nend\n";
  const auto with = [&](const char* more) {
    std::string text = program;
    return text.replace(text.find("%s"), 2, more);
  };
  const auto moved = [](Version version, const std::string& text, bool& torque_seen) {
    ControllerConfig config;
    config.series = Series::e_series;
    config.version = version;
    config.powered = true;
    Controller c(config);
    c.run(text);
    torque_seen = false;
    for (int i = 0; i < 600; ++i) {
      c.step();
      torque_seen = torque_seen || c.state().control_mode == ControlMode::torque;
    }
    CHECK(c.state().control_mode == ControlMode::position);
    return c.arm().q()[0];
  };
  bool seen = false;
  const std::string scales = ", viscous_scale=[0,0,0,0,0,0], coulomb_scale=[0,0,0,0,0,0]";
  const double plain = moved({5, 25, 1, 0}, with(""), seen);
  CHECK(seen);
  const double bare = moved({5, 25, 1, 0}, with(scales.c_str()), seen);
  CHECK(seen);
  const double off = moved({5, 23, 0, 0}, with(", friction_comp=False"), seen);
  CHECK(seen);
  CHECK(plain > bare + 0.01);
  CHECK(bare > 0.01);
  CHECK(off == doctest::Approx(bare));
  CHECK(moved({5, 24, 0, 0}, with(scales.c_str()), seen) == doctest::Approx(0).scale(1e-3));
  CHECK_FALSE(seen);
  CHECK(moved({5, 22, 0, 0}, with(""), seen) == doctest::Approx(0).scale(1e-3));
  CHECK_FALSE(seen);
}

TEST_CASE(
    "Currents: what motors spend on a way there and back under position control is what friction takes") {
  constexpr Nanoseconds period = 8'000'000;
  ArmConfig config;
  Arm arm(config, period);
  // At rest, before anything has moved, they hold the weight.
  arm.plan(1);
  for (Nanoseconds t{}; t < period; t += plant_step) arm.advance({});
  arm.measure();
  const Joints weight = gravity_torque(forward_kinematics(arm.q()));
  for (std::size_t i = 0; i < joint_count; ++i)
    CHECK(arm.motor_torque()[i] == doctest::Approx(weight[i]).epsilon(1e-9).scale(1));

  double work = 0, friction = 0, way = 0;
  for (int k = 0; k < 500; ++k) {
    const double t = seconds(period) * k, s = t > 3 ? 0 : std::pow(std::sin(pi * t / 3), 4);
    Joints q = config.home;
    for (std::size_t i = 0; i < joint_count; ++i) q[i] += (i % 2 == 0 ? 0.8 : -0.5) * s;
    arm.servo(q, 0.03, 2000);
    CHECK(arm.plan(1) == Violation::none);
    const Joints before = arm.q();
    for (Nanoseconds step{}; step < period; step += plant_step) arm.advance({});
    arm.measure();
    for (std::size_t i = 0; i < joint_count; ++i) {
      const double d = arm.q()[i] - before[i];
      work += arm.motor_torque()[i] * d, way += std::abs(d);
      friction += config.drives.viscous[i] * d * d / seconds(period) + config.drives.coulomb[i] * std::abs(d);
    }
  }
  for (std::size_t i = 0; i < joint_count; ++i)
    CHECK(arm.q()[i] == doctest::Approx(config.home[i]).epsilon(1e-4).scale(1));
  MESSAGE("work of motors " << work << " J, of friction " << friction << " J on " << way << " rad");
  CHECK(work == doctest::Approx(friction).epsilon(0.01));
}
