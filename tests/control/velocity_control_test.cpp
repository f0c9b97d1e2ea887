#include "skinctl/control/velocity_control.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
using Velocity = VelocityControl<6>;
using K = Quantities<Arm, Velocity::needs | GravityControl::needs>;
static_assert(Law<Velocity, K>);
static_assert(GoalLaw<Velocity, K>);
const Arm model;
const NoTouch touch;
constexpr double dt = 0.002;
constexpr double rate = 25;

struct Scene {
  Velocity law{rate, 100ms};
  State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
  Velocity::Memory memory{};

  void step() {
    const K known(model, x, dt, touch);
    const auto tau = law.torque(memory, known) + GravityControl{}.torque(known);
    memory = law.advance(memory, known, dt, Opposition::none);
    x = simulate(model, x, tau, dt, 4);
  }
  void ask(const JointVelocity<6>& v) {
    const K known(model, x, dt, touch);
    const auto got = law.receive(memory, known, {v});
    CHECK_FALSE(got.status.has(Reason::goal_refused));
    memory = got.memory;
  }
};
}  // namespace

TEST_CASE(
    "VelocityControl: all joints reach their velocities in the same time, heavy or light; without news they "
    "stand") {
  Scene s;
  const JointVelocity<6> wanted{0.2, -0.1, 0.15, 0.3, -0.25, 0.4};
  for (int n = 0; n < 20; ++n) s.ask(wanted), s.step();  // a time constant
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(s.x.dq[i] / wanted[i] == doctest::Approx(1 - std::exp(-1.0)).epsilon(0.05));
  for (int n = 0; n < 100; ++n) s.ask(wanted), s.step();
  for (std::size_t i = 0; i < 6; ++i) CHECK(s.x.dq[i] / wanted[i] == doctest::Approx(1).epsilon(0.05));
  for (int n = 0; n < 45; ++n) s.step();  // the last goal still holds
  for (std::size_t i = 0; i < 6; ++i) CHECK(s.x.dq[i] / wanted[i] == doctest::Approx(1).epsilon(0.05));
  for (int n = 0; n < 150; ++n) s.step();
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(s.x.dq[i]) < 0.01);
}

TEST_CASE("VelocityControl: what is no number is refused, and the last goal kept") {
  Scene s;
  s.ask(JointVelocity<6>::constant(0.1));
  const K known(model, s.x, dt, touch);
  {
    AllocationGuard guard;
    const auto tau = s.law.torque(s.memory, known);
    s.memory =
        s.law.advance(s.law.receive(s.memory, known, {JointVelocity<6>::constant(1e-3 * tau[0])}).memory,
                      known, dt, Opposition::none);
    CHECK(guard.count() == 0);
  }
  s.ask(JointVelocity<6>::constant(0.1));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const auto got = s.law.receive(s.memory, known, {JointVelocity<6>::constant(bad)});
    CHECK(got.status.has(Reason::goal_refused));
    CHECK(got.memory.wanted[3] == 0.1);
  }
  CHECK_THROWS_AS(Velocity(0.0), ConfigurationError);
  CHECK_THROWS_AS(Velocity(20.0, 0ns), ConfigurationError);
  CHECK_NOTHROW(s.law.check_for(LawTerms<6, double>{8ms, {}}));
  CHECK_THROWS_AS(s.law.check_for(LawTerms<6, double>{12ms, {}}), ConfigurationError);
  CHECK_THROWS_AS(s.law.check_for(LawTerms<6, double>{2ms, {}, 13ms}),
                  ConfigurationError);  // the delay by torque
}
