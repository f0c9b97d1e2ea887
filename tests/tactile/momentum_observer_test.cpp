// Promise: an arm without any tactile sensor is led by its motors' torque, and one with a skin feels what
// is off the skin, once
// Tried: UR5 in MuJoCo, all joints swinging at up to 1.6 rad/s: residual below 0.02 N m untouched, within
// 0.25 of 15.6 N m in a contact (rate 50 /s); led by 35 N at the forearm and left alone it comes to rest.
// Also: `cycle/sensors_test.cpp`

#include "skinctl/tactile/momentum_observer.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/mujoco_plant.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double rotor = 1;
const ur5::Model model;

RotorInertia<6> rotors() {
  std::array<double, 6> all{}, ones{};
  all.fill(rotor), ones.fill(1);
  return {all, ones};
}
using Observer = MomentumObserver<ur5::Model>;

/// A UR5 under servos in MuJoCo, which swings all joints while something pushes on its forearm.
struct Seen {
  double worst_free = 0;  ///< |r| before the contact, after the first 0.2 s [N m]
  double worst_held = 0;  ///< |r - tau_ext| in the contact, 5/rate after it began [N m]
  double strongest = 0;   ///< |tau_ext| [N m]
  double after = 0;       ///< |r| 5/rate after its end [N m]
  double fastest = 0;     ///< [rad/s]
};
Seen swing(const Observer& observer, int keep_every, double friction = 0, double noise = 0) {
  const std::vector<double> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
  oracle::MujocoPlant plant(ur5_robot().table, home, {.rotor = std::vector<double>(6, rotor)});
  Observer::Memory memory;
  Seen seen;
  Seeded random(3);
  const double settle = 5 / observer.settings().rate;
  const double at[3] = {-0.2, 0, 0}, none[3] = {};
  for (int k = 0; k < 1500; ++k) {  // 3 s, samples every 2 ms
    const double t = 0.002 * k;
    const bool pushed = t >= 1 && t < 2;
    const double force[3] = {20, -15, 25};
    for (int j = 0; j < 10; ++j) {
      double target[6];
      for (std::size_t i = 0; i < 6; ++i)
        target[i] = home[i] + 0.3 * std::sin((2 + 0.7 * double(i)) * (t + 0.0002 * j));
      plant.command(target);
      plant.step(2, at, pushed ? force : none);
    }
    if (k % keep_every != 0) continue;
    State<6> measured;
    measured.time = 2ms * (k + 1);
    JointTorque<6> motor;
    for (std::size_t i = 0; i < 6; ++i) {
      measured.q[i] = plant.q()[i];
      measured.dq[i] = plant.dq()[i] + noise * random();
      motor[i] = plant.motor_torque()[i] + friction * plant.dq()[i];
      seen.fastest = std::max(seen.fastest, std::abs(plant.dq()[i]));
    }
    CHECK_FALSE(observer.observe(memory, measured, motor).any());
    for (std::size_t i = 0; i < 6; ++i) {
      const double r = memory.residual[i], truth = plant.contact_torque()[i];
      if (t > 0.2 && t < 1) seen.worst_free = std::max(seen.worst_free, std::abs(r));
      if (pushed && t > 1 + settle) seen.worst_held = std::max(seen.worst_held, std::abs(r - truth));
      if (pushed) seen.strongest = std::max(seen.strongest, std::abs(truth));
      if (t > 2 + settle) seen.after = std::max(seen.after, std::abs(r));
    }
  }
  return seen;
}

}  // namespace

TEST_CASE("MomentumObserver: finds the torque of a contact on a swinging arm in MuJoCo") {
  const auto seen = swing(Observer(model, {.rate = 50, .rotors = rotors()}), 1);
  CHECK(seen.fastest > 1.5);
  CHECK(seen.strongest > 10);
  CHECK(seen.worst_free <= 0.02);
  CHECK(seen.worst_held <= 0.25);
  CHECK(seen.after <= 0.12);
  // Lost samples: every fifth arrives.
  const auto sparse = swing(Observer(model, {.rate = 50, .rotors = rotors()}), 5);
  CHECK(sparse.worst_held <= 0.25);
  // Without the rotors in the model it is of no use: the check above is no formality.
  CHECK(swing(Observer(model, {.rate = 50}), 1).worst_free > 1);
}

TEST_CASE("MomentumObserver: declared friction is taken off") {
  JointFriction<6>::Settings friction;
  for (std::size_t i = 0; i < 6; ++i) friction.viscous[i] = 5;
  const auto with =
      swing(Observer(model, {.rate = 50, .rotors = rotors(), .friction = JointFriction<6>(friction)}), 1, 5);
  CHECK(with.worst_free <= 0.02);
  CHECK(swing(Observer(model, {.rate = 50, .rotors = rotors()}), 1, 5).worst_free > 5);
}

TEST_CASE("MomentumObserver: an arm at rest shows a step as the filter says, for every rate times dt") {
  for (const double rate : {1.0, 50.0, 400.0, 2000.0, 10000.0}) {
    const Observer observer(model, {.rate = rate});
    Observer::Memory memory;
    const JointPosition<6> q{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
    // A brake holds the arm; the motor holds gravity less a contact of 7 N m.
    const auto G = gravity_torque(model, q);
    JointTorque<6> motor = G;
    CAPTURE(rate);
    for (int k = 0; k < 500; ++k) {
      if (k == 1) motor[1] -= 7;  // from the second sample on; the trapezoid counts half of it there
      CHECK_FALSE(observer.observe(memory, {2ms * (k + 1), q, {}}, motor).any());
      const double keep = std::exp(-rate * 0.002);
      const double expected = k == 0 ? 0 : 7 * (1 - std::pow(keep, k - 1) * (1 - 0.5 * (1 - keep)));
      CHECK(std::abs(memory.residual[1] - expected) <= 1e-9);
      CHECK(std::abs(memory.residual[0]) <= 1e-9);
    }
  }
}

TEST_CASE("MomentumObserver: noise of dq gives the stated noise") {
  const double sigma = 1e-3, rate = 50;
  const Observer observer(model, {.rate = rate, .rotors = rotors()});
  Observer::Memory memory;
  Seeded random(9);
  const JointPosition<6> q{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
  const auto M = mass_matrix(model, q);
  const auto motor = gravity_torque(model, q);
  double square = 0;
  int counted = 0;
  for (int k = 0; k < 20000; ++k) {
    State<6> at{2ms * (k + 1), q, {}};
    at.dq[1] = std::sqrt(3.0) * sigma * random();  // uniform, of deviation sigma
    static_cast<void>(observer.observe(memory, at, motor));
    if (k > 200) square += memory.residual[1] * memory.residual[1], ++counted;
  }
  const double stated = (M(1, 1) + rotor) * sigma * rate;
  CHECK(std::sqrt(square / counted) == doctest::Approx(stated).epsilon(0.1));
}

TEST_CASE("MomentumObserver: refuses what cannot be, and bridges or begins anew") {
  const Observer observer(model, {.max_gap = 20ms});
  const JointPosition<6> q{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
  const auto motor = gravity_torque(model, q);
  Observer::Memory memory;
  const auto at = [&](Nanoseconds t) { return State<6>{t, q, {}}; };
  CHECK_FALSE(observer.observe(memory, at(2ms), motor).any());
  const auto good = memory;
  CHECK(observer.observe(memory, at(2ms), motor) == Status(Reason::time_backwards));
  CHECK(observer.observe(memory, at(1ms), motor) == Status(Reason::time_backwards));
  for (std::size_t i = 0; i < 6; ++i) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      auto wrong = at(4ms);
      wrong.dq[i] = bad;
      CHECK(observer.observe(memory, wrong, motor) == Status(Reason::sample_not_finite));
      wrong = at(4ms);
      wrong.q[i] = bad;
      CHECK(observer.observe(memory, wrong, motor) == Status(Reason::sample_not_finite));
      auto torque = motor;
      torque[i] = bad;
      CHECK(observer.observe(memory, at(4ms), torque) == Status(Reason::sample_not_finite));
    }
  }
  CHECK(memory == good);
  auto pressed = motor;
  pressed[1] -= 5;
  CHECK_FALSE(observer.observe(memory, at(12ms), pressed).any());
  CHECK(memory.residual[1] > 0.1);
  CHECK_FALSE(observer.observe(memory, at(33ms), pressed).any());
  CHECK(memory.residual[1] == 0);  // longer than 20 ms: anew
  CHECK_THROWS_AS(Observer(model, {.rate = 0}), ConfigurationError);
  CHECK_THROWS_AS(Observer(model, {.rate = std::nan("")}), ConfigurationError);
  CHECK_THROWS_AS(Observer(model, {.max_gap = 0ns}), ConfigurationError);
}
