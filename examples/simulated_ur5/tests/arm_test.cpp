#include "examples/simulated_ur5/arm.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "skinctl/core/contract.hpp"

using namespace simulated_ur5;

namespace {

ArmConfig exact() {
  ArmConfig c;
  c.position_noise = 0;
  c.velocity_noise = 0;
  return c;
}

/// Plans and moves one cycle; returns the violation.
Violation cycle(Arm& arm, Nanoseconds period, const Joints& load = {}, double fraction = 1) {
  const Violation v = arm.plan(fraction);
  for (Nanoseconds t{}; t < period; t += plant_step) arm.advance(load);
  arm.measure();
  return v;
}

double worst(const Joints& v) {
  double m = 0;
  for (double x : v) m = std::max(m, std::abs(x));
  return m;
}

constexpr Nanoseconds periods[] = {8'000'000, 2'000'000};

}  // namespace

TEST_CASE(
    "Arm: behind a smooth servoj path comes the target by the lookahead, and the joints by delay and lag") {
  for (const Nanoseconds period : periods) {
    for (const double delay : {0.0, 0.002, 0.008, 0.020}) {
      for (const double lag : {0.0, 0.008, 0.05}) {
        CAPTURE(period);
        CAPTURE(delay);
        CAPTURE(lag);
        ArmConfig config = exact();
        config.delay = delay;
        config.lag = lag;
        Arm arm(config, period);
        const double dt = seconds(period), v = 0.7;
        // A ramp with a soft start: its steady state lags by exactly v (lookahead + delay + lag).
        double s = 0;
        for (int k = 1; k * dt <= 2.0; ++k) {
          const double t = k * dt;
          s = t < 0.2 ? 0.5 * v / 0.2 * t * t : 0.5 * v * 0.2 + v * (t - 0.2);
          Joints q = config.home;
          q[1] += s;
          arm.servo(q, 0.03, 2000);
          REQUIRE(cycle(arm, period) == Violation::none);
        }
        CHECK(arm.target_q()[1] == doctest::Approx(config.home[1] + s - v * 0.03).epsilon(1e-9));
        CHECK(arm.q()[1] == doctest::Approx(config.home[1] + s - v * (0.03 + delay + lag)).epsilon(1e-9));
        CHECK(arm.dq()[1] == doctest::Approx(v).epsilon(1e-6));
        CHECK(arm.q()[0] == config.home[0]);
      }
    }
  }
}

TEST_CASE("Arm: the response to speedj is the closed form of ramp, delay and lag") {
  ArmConfig config = exact();
  config.delay = 0.012;
  config.lag = 0.02;
  Arm arm(config, 2'000'000);
  const double a = 10, v = 0.5;
  for (int k = 1; k <= 500; ++k) {
    arm.speed({0, 0, v, 0, 0, 0}, a);
    REQUIRE(cycle(arm, 2'000'000) == Violation::none);
    const double t = 0.002 * k;
    // u(t) = integral of min(a t, v); y = u delayed through 1/(lag s + 1), by superposition of two ramps in
    // speed.
    const auto y = [&](double s) {
      if (s <= 0) return 0.0;
      const double T = config.lag;
      return a * (0.5 * s * s - T * s + T * T * (1 - std::exp(-s / T)));
    };
    const double expected = y(t - config.delay) - y(t - config.delay - v / a);
    // Between cycles the target is linear, which cuts a parabola short by at most a dt^2 / 8.
    CHECK(std::abs(arm.q()[2] - config.home[2] - expected) < a * 0.002 * 0.002 / 8 + 1e-12);
  }
}

TEST_CASE("Arm: servoj lags by its lookahead and by its gain, speedj by neither") {
  const auto behind = [&](double lookahead, double gain) {
    Arm arm(exact(), 2'000'000);
    Joints q = arm.config().home;
    for (int k = 0; k < 1000; ++k) {
      q[0] += 0.5 * 0.002;
      arm.servo(q, lookahead, gain);
      cycle(arm, 2'000'000);
    }
    return (q[0] - arm.q()[0]) / 0.5;
  };
  CHECK(behind(0.03, 2000) == doctest::Approx(0.008 + 0.008 + 0.03).epsilon(1e-6));
  CHECK(behind(0.1, 2000) == doctest::Approx(0.008 + 0.008 + 0.1).epsilon(1e-6));
  CHECK(behind(0.03, 500) == doctest::Approx(0.008 + 0.032 + 0.03).epsilon(1e-6));
  CHECK(behind(-1, 1e9) == doctest::Approx(0.046).epsilon(1e-6));

  Arm arm(exact(), 2'000'000);
  for (int k = 0; k < 1000; ++k) {
    arm.speed({0.5, 0, 0, 0, 0, 0}, 40);
    cycle(arm, 2'000'000);
  }
  CHECK((arm.target_q()[0] - arm.q()[0]) / 0.5 == doctest::Approx(0.016).epsilon(1e-6));
}

TEST_CASE("Arm: a step of servoj within the limits is smoothed by a first-order lag of the lookahead") {
  ArmConfig config = exact();
  config.delay = config.lag = 0;
  config.acceleration_limit = {1e5, 1e5, 1e5, 1e5, 1e5, 1e5};
  Arm arm(config, 2'000'000);
  Joints q = config.home;
  q[0] += 1e-3;
  for (int k = 1; k <= 100; ++k) {
    arm.servo(q, 0.05, 2000);
    REQUIRE(cycle(arm, 2'000'000) == Violation::none);
    // The command comes as a ramp over the first cycle.
    const double T = 0.05, t = 0.002 * k, left = T / 0.002 * (std::exp(-(t - 0.002) / T) - std::exp(-t / T));
    CHECK(std::abs(arm.q()[0] - config.home[0] - 1e-3 * (1 - left)) < 1e-12);
  }
}

TEST_CASE("Arm: whatever is commanded, the target obeys speed and acceleration limits") {
  Random random(7);
  for (const Nanoseconds period : periods) {
    ArmConfig config = exact();
    config.step_tolerance = 1000;
    config.lower = {-900, -900, -900, -900, -900, -900};
    config.upper = {900, 900, 900, 900, 900, 900};
    Arm arm(config, period);
    Joints before = arm.target_dq();
    Joints q = config.home;
    for (int k = 0; k < 20000; ++k) {
      const double what = random.uniform();
      Joints v{};
      for (double& x : v) x = 4 * (2 * random.uniform() - 1);
      if (what < 0.2) {
        for (std::size_t i = 0; i < joint_count; ++i) q[i] = arm.target_q()[i] + 0.3 * v[i];
        arm.servo(q, 0.03, 2000);
      } else if (what < 0.4) {
        arm.speed(v, 40 * random.uniform());
      } else if (what < 0.5) {
        arm.stop(4);
      }
      REQUIRE(cycle(arm, period, {}, random.uniform() < 0.1 ? random.uniform() : 1) == Violation::none);
      for (std::size_t i = 0; i < joint_count; ++i) {
        REQUIRE(std::abs(arm.target_dq()[i]) <= config.velocity_limit[i] * (1 + 1e-9));
        REQUIRE(std::abs(arm.target_dq()[i] - before[i]) <=
                config.acceleration_limit[i] * seconds(period) * (1 + 1e-9) + 1e-12);
        REQUIRE(std::abs(arm.dq()[i]) <= config.velocity_limit[i] * 1.01);
      }
      before = arm.target_dq();
    }
  }
}

TEST_CASE("Arm: a far servoj goal is reached without overshoot") {
  for (const Nanoseconds period : periods) {
    ArmConfig config = exact();
    config.step_tolerance = 1000;
    Arm arm(config, period);
    Joints goal = config.home;
    goal[0] += 1.0;
    goal[4] -= 0.3;
    double highest = -1e9, lowest = 1e9;
    for (double t = 0; t < 2; t += seconds(period)) {
      arm.servo(goal, 0.03, 2000);
      REQUIRE(cycle(arm, period) == Violation::none);
      highest = std::max(highest, arm.q()[0]);
      lowest = std::min(lowest, arm.q()[4]);
    }
    CHECK(arm.q()[0] == doctest::Approx(goal[0]).epsilon(1e-9));
    CHECK(highest <= goal[0] + 1e-6);
    CHECK(lowest >= goal[4] - 1e-6);
  }
}

TEST_CASE("Arm: stopj takes the leading axis to rest at the given deceleration, the others along") {
  ArmConfig config = exact();
  Arm arm(config, 2'000'000);
  for (int k = 0; k < 300; ++k) {
    arm.speed({0.8, -0.4, 0, 0, 0.2, 0}, 40);
    cycle(arm, 2'000'000);
  }
  arm.stop(4);
  int cycles = 0;
  while (worst(arm.target_dq()) > 0) {
    const double ratio = arm.target_dq()[1] / arm.target_dq()[0];
    CHECK(ratio == doctest::Approx(-0.5).epsilon(1e-6));
    cycle(arm, 2'000'000);
    REQUIRE(++cycles < 1000);
  }
  CHECK(cycles * 0.002 == doctest::Approx(0.2).epsilon(0.02));
  CHECK_FALSE(arm.at_rest());  // the motion is still on its way through delay and lag
  for (int k = 0; k < 100; ++k) cycle(arm, 2'000'000);
  CHECK(arm.at_rest());
}

TEST_CASE("Arm: movej arrives, straight in joint space, in the time of a trapezoid") {
  for (const Nanoseconds period : periods) {
    ArmConfig config = exact();
    Arm arm(config, period);
    Joints goal = config.home;
    goal[0] += 1.2;
    goal[2] += 0.6;
    arm.move(goal, 1.4, 1.05, 0);
    double t = 0;
    while (arm.moving()) {
      REQUIRE(cycle(arm, period) == Violation::none);
      t += seconds(period);
      REQUIRE(t < 10);
      const double a = arm.target_q()[0] - config.home[0], b = arm.target_q()[2] - config.home[2];
      CHECK(b == doctest::Approx(0.5 * a).epsilon(1e-9));
      CHECK(std::abs(arm.target_dq()[0]) <= 1.05 * (1 + 1e-9));
    }
    CHECK(arm.target_q() == goal);
    CHECK(t == doctest::Approx(1.2 / 1.05 + 1.05 / 1.4).epsilon(0.03));
    // A given time counts instead.
    arm.move(config.home, 0.1, 0.1, 2.0);
    for (t = 0; arm.moving(); t += seconds(period)) {
      cycle(arm, period);
      REQUIRE(t < 10);
    }
    CHECK(t == doctest::Approx(2.0).epsilon(0.02));
  }
}

TEST_CASE("Arm: steps, speeds and limits beyond what a robot accepts are violations, and the arm brakes") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto first = [&](auto&& command) {
    Arm arm(exact(), 8'000'000);
    command(arm);
    return cycle(arm, 8'000'000);
  };
  Joints near = ArmConfig{}.home, far = ArmConfig{}.home, none = ArmConfig{}.home;
  near[0] += 0.02;
  far[0] += 0.06;  // 7.5 rad/s
  none[3] = nan;
  CHECK(first([&](Arm& a) { a.servo(near, 0.03, 2000); }) == Violation::none);
  CHECK(first([&](Arm& a) { a.servo(far, 0.03, 2000); }) == Violation::position_step);
  CHECK(first([&](Arm& a) { a.servo(none, nan, nan); }) == Violation::not_a_number);
  CHECK(first([&](Arm& a) { a.speed({0, 0, 7, 0, 0, 0}, 40); }) == Violation::speed);
  CHECK(first([&](Arm& a) { a.speed({0, nan, 0, 0, 0, 0}, 40); }) == Violation::not_a_number);
  CHECK(first([&](Arm& a) { a.speed({0, 0, 1, 0, 0, 0}, nan); }) == Violation::none);

  Arm arm(exact(), 8'000'000);
  Violation seen = Violation::none;
  for (int k = 0; k < 1000 && seen == Violation::none; ++k) {
    arm.speed({0, 0, 1, 0, 0, 0}, 40);
    seen = cycle(arm, 8'000'000);
  }
  CHECK(seen == Violation::joint_limit);
  for (int k = 0; k < 100; ++k) cycle(arm, 8'000'000);
  CHECK(cycle(arm, 8'000'000) == Violation::none);
  CHECK(arm.at_rest());
  CHECK(arm.q()[2] - pi < 1.0 / 20 + 0.02);
  // Inward motion is allowed again.
  arm.speed({0, 0, -0.5, 0, 0, 0}, 40);
  CHECK(cycle(arm, 8'000'000) == Violation::none);
}

TEST_CASE("Arm: a missed command is no violation, and a speed slider slows") {
  ArmConfig config = exact();
  Arm arm(config, 8'000'000);
  Joints q = config.home;
  for (int k = 0; k < 300; ++k) {
    q[0] += 1.5 * 0.008;
    if (k % 10 != 0) arm.servo(q, 0.03, 2000);
    REQUIRE(cycle(arm, 8'000'000) == Violation::none);
  }
  CHECK(arm.target_q()[0] == doctest::Approx(q[0]).epsilon(0.01));

  Arm slow(config, 8'000'000);
  for (int k = 0; k < 200; ++k) {
    slow.speed({0.4, 0, 0, 0, 0, 0}, 40);
    cycle(slow, 8'000'000, {}, 0.25);
  }
  CHECK(slow.dq()[0] == doctest::Approx(0.1).epsilon(1e-6));
}

TEST_CASE("Arm: droops under load by its stiffness, in the end not with an integral, never when rigid") {
  const Joints load = {0, 40, -20, 0, 0, 0};
  for (const double stiffness : {500.0, 2e4, rigid}) {
    ArmConfig config = exact();
    config.stiffness.fill(stiffness);
    Arm arm(config, 2'000'000);
    for (int k = 0; k < 200; ++k) cycle(arm, 2'000'000, load);
    CHECK(arm.q()[1] - config.home[1] == doctest::Approx(40 / stiffness));
    CHECK(arm.q()[2] - config.home[2] == doctest::Approx(-20 / stiffness));

    // What comes and goes: (e^(p t) - e^(r t)) / (lag (p - r)), p and r the roots of lag s^2 + s + 1/T_i.
    config.integral_time = 0.2;
    Arm corrects(config, 2'000'000);
    const double root = std::sqrt(1 - 4 * config.lag / 0.2), p = (-1 + root) / (2 * config.lag),
                 r = (-1 - root) / (2 * config.lag);
    for (int k = 1; k <= 1000; ++k) {
      cycle(corrects, 2'000'000, load);
      const double t = 0.002 * k, z = (std::exp(p * t) - std::exp(r * t)) / (config.lag * (p - r));
      CHECK(std::abs(corrects.q()[1] - config.home[1] - 40 / stiffness * z) <= 0.04 * 40 / stiffness);
    }
    CHECK(std::abs(corrects.q()[1] - config.home[1]) <= 1e-3 * 40 / stiffness);
  }
}

TEST_CASE("Arm: encoder noise has the declared size and comes from the seed") {
  ArmConfig config;
  Arm a(config, 2'000'000), b(config, 2'000'000), c(config, 2'000'000);
  a.reseed(5);
  b.reseed(5);
  c.reseed(6);
  double sum = 0;
  bool differs = false;
  for (int k = 0; k < 5000; ++k) {
    cycle(a, 2'000'000);
    cycle(b, 2'000'000);
    cycle(c, 2'000'000);
    REQUIRE(a.measured_q() == b.measured_q());
    differs = differs || a.measured_q() != c.measured_q();
    sum += std::pow(a.measured_q()[0] - a.q()[0], 2);
  }
  CHECK(differs);
  CHECK(std::sqrt(sum / 5000) == doctest::Approx(config.position_noise).epsilon(0.05));
}

TEST_CASE("Arm: refuses numbers that cannot work") {
  const auto refused = [](auto&& change) {
    ArmConfig c;
    change(c);
    CHECK_THROWS_AS(Arm(c, 8'000'000), skinctl::ConfigurationError);
  };
  refused([](ArmConfig& c) { c.delay = -1; });
  refused([](ArmConfig& c) { c.lag = std::numeric_limits<double>::quiet_NaN(); });
  refused([](ArmConfig& c) { c.velocity_limit[3] = 0; });
  refused([](ArmConfig& c) { c.lower[0] = 7; });
  refused([](ArmConfig& c) { c.home[0] = 7; });
  refused([](ArmConfig& c) { c.stiffness[2] = 50; });
  refused([](ArmConfig& c) { c.integral_time = 0; });
  refused([](ArmConfig& c) { c.unknown_payload = -1; });
  CHECK_THROWS_AS(Arm(ArmConfig{}, 300'000), skinctl::ConfigurationError);
}
