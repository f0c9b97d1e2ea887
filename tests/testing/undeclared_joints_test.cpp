#include "skinctl/testing/undeclared_joints.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/testing/random.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl::testing;

namespace {

using Joints = UndeclaredJoints<1>;
using Truth = JointTruth<1>;
using Kind = Joints::Kind;

/// Steps of a millisecond to `t`.
void run_to(Joints& joints, double t) {
  while (joints.time() < t - 1e-12) joints.advance(std::min(t, joints.time() + 1e-3));
}

}  // namespace

TEST_CASE("A delay and a lag: those of simulated joints") {
  for (const bool by_position : {true, false}) {
    const std::array<double, 2> q{0.3, -0.2};
    using Simulated = SimulatedJoints<2>;
    using Undeclared = UndeclaredJoints<2>;
    Simulated declared(by_position ? Simulated::Kind::position : Simulated::Kind::velocity, 0.013, 0.02, q);
    Undeclared joints(by_position ? Undeclared::Kind::position : Undeclared::Kind::velocity,
                      {.delay = 0.013, .lag = 0.02}, q);
    Seeded random(3);
    double t = 0;
    for (int k = 0; k < 1000; ++k) {
      t += 0.008 * (1 + 0.9 * random());
      declared.advance(t), joints.advance(t);
      for (std::size_t i = 0; i < 2; ++i) {
        REQUIRE(std::abs(joints.q()[i] - declared.q()[i]) < 1e-12);
        REQUIRE(std::abs(joints.dq()[i] - declared.dq()[i]) < 1e-9);
      }
      const std::array<double, 2> to{random(), random()};
      declared.command(t, to), joints.command(t, to);
    }
  }
}

TEST_CASE("Two lags: the response to a step in closed form") {
  const double way = 0.4;
  for (const double a : {0.0, 0.01, 0.03})
    for (const double b : {0.0, 0.01, 0.05})
      for (const bool by_position : {true, false}) {
        CAPTURE(a);
        CAPTURE(b);
        CAPTURE(by_position);
        Joints joints(by_position ? Kind::position : Kind::velocity,
                      {.delay = 0.005, .lookahead = a, .lag = b}, {1});
        joints.command(0, {by_position ? 1 + way : way});
        for (double t = 0.003; t < 0.3; t += 0.003) {
          joints.advance(t);
          const double s = std::max(0.0, t - 0.005);
          const auto left = [&](double T) { return T > 0 ? std::exp(-s / T) : (s > 0 ? 0.0 : 1.0); };
          // What is left of a step behind two lags, and its integral, the way behind a ramp.
          const bool same = a == b && a > 0;
          const double step =
              same ? (1 + s / a) * left(a) : (a == b ? left(0) : (a * left(a) - b * left(b)) / (a - b));
          const double behind =
              same ? 2 * a * (1 - left(a)) - s * left(a)
                   : (a == b ? 0.0 : (a * a * (1 - left(a)) - b * b * (1 - left(b))) / (a - b));
          REQUIRE(std::abs(joints.q()[0] - (by_position ? 1 + way * (1 - step) : 1 + way * (s - behind))) <
                  1e-12);
        }
      }
}

TEST_CASE("The delay jitters within its bounds and keeps the order") {
  Joints joints(Kind::position, {.delay = 0.01, .delay_jitter = 0.004}, {0});
  double earliest = 1, latest = 0, before = 0;
  for (int k = 1; k <= 500; ++k) {
    joints.command(0.02 * k, {double(k)});
    for (int n = 0; n < 200; ++n) {
      joints.advance(0.02 * k + 1e-4 * n);
      const double q = joints.q()[0];
      REQUIRE(q >= before);
      if (q > before) earliest = std::min(earliest, 1e-4 * n), latest = std::max(latest, 1e-4 * n);
      before = q;
    }
  }
  CHECK(before == 500);
  CHECK(earliest >= 0.006);
  CHECK(earliest < 0.0063);
  CHECK(latest <= 0.0141);
  CHECK(latest > 0.0137);
}

TEST_CASE("A load moves a soft joint: torque over stiffness, critically damped") {
  for (const double k : {500.0, 2000.0, 2e4, 2e5})
    for (const bool by_position : {true, false}) {
      CAPTURE(k);
      Truth truth{.stiffness = {k}, .inertia = {2}};
      Joints joints(by_position ? Kind::position : Kind::velocity, truth, {0.1});
      joints.external({-30});
      const double w = std::sqrt(k / 2);
      for (double t = 1e-3; t < 2; t += 1e-3) {
        joints.advance(t);
        const double z = -30 / k * (1 - (1 + w * t) * std::exp(-w * t));
        REQUIRE(std::abs(joints.q()[0] - 0.1 - z) < 0.25 * 0.5e-3 * w * 30 / k);  // a step of first order
      }
      CHECK(std::abs(joints.q()[0] - 0.1 + 30 / k) < 1e-6 * 30 / k);
    }
}

TEST_CASE("A servo follows its reference whatever its stiffness; load is all that comes beside") {
  for (const double k : {500.0, 1e5}) {
    Truth ideal{.delay = 0.004, .lookahead = 0.03, .lag = 0.008}, soft = ideal;
    soft.stiffness = {k};
    for (const auto kind : {Kind::position, Kind::velocity}) {
      Joints a(kind, ideal, {0}), b(kind, soft, {0});
      b.external({10});
      for (int n = 1; n < 4000; ++n) {
        const double t = 1e-3 * n;
        a.advance(t), b.advance(t);
        if (t > 2) REQUIRE(std::abs(b.q()[0] - a.q()[0] - 10 / k) < 1e-4);
        a.command(t, {std::sin(2 * t)}), b.command(t, {std::sin(2 * t)});
      }
    }
  }
}

TEST_CASE("An integral takes the droop away") {
  Truth truth{.stiffness = {2000}, .integral_time = 0.3};
  Joints joints(Kind::position, truth, {0});
  joints.external({40});
  double area = 0, most = 0;
  for (int k = 0; k < 4000; ++k) {
    joints.advance(1e-3 * (k + 1));
    area += 1e-3 * joints.q()[0];
    most = std::max(most, joints.q()[0]);
  }
  CHECK(std::abs(joints.q()[0]) < 1e-5);
  CHECK(area == doctest::Approx(40.0 / 2000 * 0.3).epsilon(1e-3));  // k/T_i times it is the load
  CHECK(most > 0.5 * 40 / 2000);
  CHECK(most < 40.0 / 2000);
}

TEST_CASE("Friction: at rest it holds up to stiction, in motion it takes Coulomb's torque") {
  Truth truth{.stiffness = {2000}, .coulomb = {20}, .stiction = {30}};
  for (const double load : {29.9, 30.1}) {
    Joints joints(Kind::position, truth, {0});
    joints.external({load});
    run_to(joints, 3);
    CHECK(joints.q()[0] == doctest::Approx(load < 30 ? 0 : (load - 20) / 2000).epsilon(1e-3));
  }
  // By position it stays short of its reference by what friction holds.
  truth.lag = 1;
  Joints joints(Kind::position, truth, {0});
  joints.command(0, {0.014});  // 28 N m
  run_to(joints, 15);
  CHECK(joints.q()[0] == 0);
  CHECK(joints.reference()[0] == doctest::Approx(0.014).epsilon(1e-5));
  joints.command(15, {0.3});
  run_to(joints, 35);
  CHECK(joints.q()[0] == doctest::Approx(0.3 - 20.0 / 2000).epsilon(1e-3));
}

TEST_CASE("A servo gives way at its limit of torque") {
  Truth truth{.stiffness = {5000}, .inertia = {2}, .torque_limit = {50}};
  Joints joints(Kind::position, truth, {0});
  joints.external({-49});
  run_to(joints, 1);
  CHECK(joints.q()[0] == doctest::Approx(-49.0 / 5000).epsilon(1e-4));
  const double from = joints.q()[0];
  joints.external({-54});  // 4 N m too much
  run_to(joints, 2);
  CHECK(joints.q()[0] - from == doctest::Approx(-0.5 * 4 / 2).epsilon(0.01));
}

TEST_CASE("A servo at its limit of torque goes to a step without flying past it") {
  for (const double delay : {0.0, 0.0007, 0.0009, 0.00099}) {
    CAPTURE(delay);
    Truth truth{.delay = delay, .lag = 0.0042, .stiffness = {12648}, .inertia = {0.3}, .torque_limit = {28}};
    Joints joints(Kind::position, truth, {0});
    joints.command(0, {0.035});
    double most = 0, fastest = 0;
    for (int k = 1; k < 500; ++k) {
      joints.advance(1e-3 * k);
      most = std::max(most, joints.q()[0]);
      fastest = std::max(fastest, joints.dq()[0]);
    }
    CHECK(joints.q()[0] == doctest::Approx(0.035).epsilon(1e-6));
    CHECK(most < 1.1 * 0.035);
    CHECK(fastest <= std::sqrt(2 * 28 / 0.3 * 0.035));  // as fast as that torque gets over the whole way
  }
}

TEST_CASE(
    "A servo with next to no lag goes the way of positions that are held for a while, and not the other "
    "way") {
  for (const double lag : {0.0005, 0.0025, 0.01})
    for (const double speed : {0.2, 1.0}) {
      CAPTURE(lag);
      CAPTURE(speed);
      Truth truth{.lag = lag, .stiffness = {900}, .inertia = {3}, .torque_limit = {150}};
      Joints joints(Kind::position, truth, {0});
      double t = 0;
      for (int k = 1; k < 100; ++k) {
        joints.command(t, {speed * 0.008 * k});
        run_to(joints, t += 0.008);
        REQUIRE(joints.q()[0] > -1e-6);
        REQUIRE(std::abs(joints.q()[0] - joints.reference()[0]) < 0.1 * speed);
      }
    }
}

TEST_CASE("Encoders: gap, steps, noise, repetitions and stamps") {
  const double gap = 6.283185307179586 + 0.025;
  Joints exact(Kind::position, {.gap = {gap}}, {0.1});
  CHECK(exact.measured().q[0] == 0.1 + gap);
  CHECK(exact.q()[0] == 0.1);

  Truth truth{.noise = 2e-4, .skipped = 0.1, .stamp_jitter = 1e-3};
  Joints joints(Kind::position, truth, {0.5}, 7);
  double sum = 0, squares = 0, off = 0;
  int repeated = 0;
  const int n = 20000;
  double last = -1;
  for (int k = 1; k <= n; ++k) {
    joints.advance(0.002 * k);
    const auto m = joints.measured();
    if (!m.fresh) {
      ++repeated;
      CHECK(m.time == last);
      continue;
    }
    last = m.time;
    off = std::max(off, std::abs(m.time - joints.time()));
    sum += m.q[0] - 0.5;
    squares += (m.q[0] - 0.5) * (m.q[0] - 0.5);
  }
  CHECK(std::abs(repeated - 0.1 * n) < 4 * std::sqrt(0.09 * n));
  const double fresh = n - repeated;
  CHECK(std::sqrt(squares / fresh) == doctest::Approx(2e-4).epsilon(4 / std::sqrt(2 * fresh)));
  CHECK(std::abs(sum / fresh) < 4 * 2e-4 / std::sqrt(fresh));
  CHECK(off <= 1e-3);
  CHECK(off > 0.99e-3);

  Joints coarse(Kind::velocity, {.resolution = 1e-3}, {0});
  coarse.command(0, {0.1});
  for (int k = 1; k < 1000; ++k) {
    coarse.advance(1e-3 * k);
    const double q = coarse.measured().q[0];
    REQUIRE(std::abs(q - coarse.q()[0]) <= 0.5e-3 + 1e-12);
    REQUIRE(std::abs(q / 1e-3 - std::round(q / 1e-3)) < 1e-9);
  }
}

TEST_CASE("Held fast it stays; set free it goes on without a jump") {
  for (const auto kind : {Kind::position, Kind::velocity})
    for (const double k : {5000.0, Truth::infinite}) {
      CAPTURE(k);
      Truth truth{.lag = 0.02, .stiffness = {k}, .torque_limit = {100}};
      Joints joints(kind, truth, {0.2});
      joints.hold_fast(0, true);
      joints.command(0, {1});
      run_to(joints, 2);
      CHECK(joints.q()[0] == 0.2);
      CHECK(joints.dq()[0] == 0);
      joints.hold_fast(0, false);
      joints.advance(2.001);
      // By velocity it had pushed with up to its limit of torque: the way that this is worth comes back.
      CHECK(joints.q()[0] - 0.2 < (kind == Kind::position ? 0.001 / 0.02 * 0.8 + 1e-9 : 0.0011));
      run_to(joints, 4);
      // By velocity: 2 s at 1 rad/s, and what it had wound up, less the start with that torque at most.
      const double wound_up = k < Truth::infinite ? 100 / k : 0, start = k < Truth::infinite ? 0.5 / 100 : 0;
      if (kind == Kind::position) {
        CHECK(joints.q()[0] == doctest::Approx(1).epsilon(1e-6));
      } else {
        CHECK(joints.q()[0] - 2.2 <= wound_up + 1e-6);
        CHECK(joints.q()[0] - 2.2 >= wound_up - start - 1e-6);
      }
    }
}

TEST_CASE("A hand moves a joint, a slider slows it, a top speed bounds it") {
  Joints position(Kind::position, {.lag = 0.02}, {0}), velocity(Kind::velocity, {.lag = 0.02}, {0});
  position.displace(0, 0.1), velocity.displace(0, 0.1);
  run_to(position, 0.02), run_to(velocity, 0.02);
  CHECK(position.q()[0] == doctest::Approx(0.1 * std::exp(-1)));
  CHECK(velocity.q()[0] == 0.1);

  Joints slow(Kind::position, {.lag = 0.02}, {0}), slow_velocity(Kind::velocity, {}, {0});
  slow.slider(0.25), slow_velocity.slider(0.25);
  slow.command(0, {1}), slow_velocity.command(0, {1});
  run_to(slow, 0.08), run_to(slow_velocity, 2);
  CHECK(slow.q()[0] == doctest::Approx(1 - std::exp(-1)));
  CHECK(slow_velocity.q()[0] == doctest::Approx(0.5));

  for (const double k : {1e4, Truth::infinite}) {
    Joints bounded(Kind::position, {.max_speed = 0.5, .stiffness = {k}}, {0});
    bounded.command(0, {1});
    run_to(bounded, 1);
    CHECK(bounded.q()[0] == doctest::Approx(0.5).epsilon(1e-6));
    run_to(bounded, 3);
    CHECK(bounded.q()[0] == doctest::Approx(1).epsilon(1e-6));
  }
}

TEST_CASE("Stable for every stiffness and step: under any load it gives way by at most that over stiffness") {
  for (const double k : {500.0, 1e4, 1e7, 1e12})
    for (const double step : {0.25e-3, 1e-3, 8e-3}) {
      CAPTURE(k);
      CAPTURE(step);
      Truth truth{.stiffness = {k}, .coulomb = {5}, .stiction = {10}};
      Joints joints(Kind::velocity, truth, {0});
      Seeded random(5);
      for (int n = 1; n < 4000; ++n) {
        joints.external({100 * random()});
        joints.advance(step * n);
        REQUIRE(std::abs(joints.q()[0]) <= 1.0001 * 100 / k);
      }
    }
}
