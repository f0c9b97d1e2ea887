#include "skinctl/control/impedance.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/largest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
template <class L>
using KnownFor = Quantities<Arm, L::needs>;
using Cartesian = CartesianImpedance<6, 5>;
const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0.02, 0, 0.15);
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};
static_assert(Law<JointImpedance<6>, KnownFor<JointImpedance<6>>> && Law<Cartesian, KnownFor<Cartesian>>);
static_assert(std::is_trivially_copyable_v<Cartesian::Memory>);

Cartesian cartesian() {
  Cartesian::Settings s;
  s.stiffness = {800, 800, 800, 60, 60, 60};
  s.damping = {120, 120, 120, 8, 8, 8};
  s.joint_damping = JointTorque<6>::constant(0.2);
  return Cartesian(OperationalSpace<6, 5>(X_LT), s);
}
}  // namespace

TEST_CASE("Impedance: a force on the tool moves it by force over stiffness") {
  const auto law = cartesian();
  using K = KnownFor<Cartesian>;
  State<6> x{0ns, home, {}};
  auto memory = law.start(K(model, x, 0.002, none));
  const auto X0 = law.space().site(K(model, x, 0.002, none)).X_BP;
  const Xyz<double> force{6, -8, 4};
  for (int i = 0; i < 2000; ++i) {
    const K known(model, x, 0.002, none);
    const auto out = evaluate(law, memory, known, 0.002);
    memory = out.memory;
    const auto J = known.jacobian<5>(X_LT);
    x = simulate(model, x, out.torque + transpose(J) * decltype(J)::Load{force, {}}, 0.002, 1);
  }
  const auto moved = law.space().site(K(model, x, 0.002, none)).X_BP.origin() - X0.origin();
  CHECK(800 * moved.x == doctest::Approx(force.x).epsilon(1e-3));
  CHECK(800 * moved.y == doctest::Approx(force.y).epsilon(1e-3));
  CHECK(800 * moved.z == doctest::Approx(force.z).epsilon(1e-3));
}

TEST_CASE("Impedance: settled when its target and the robot stand") {
  const JointImpedance<6> law{JointImpedance<6>::Settings{}};
  State<6> x{0ns, home, {}};
  using K = KnownFor<JointImpedance<6>>;
  auto memory = law.start(K(model, x, 0.002, none));
  CHECK(settled(law, memory, K(model, x, 0.002, none), 0.01));
  memory = law.receive(memory, K(model, x, 0.002, none), {home + JointPosition<6>::constant(0.1), 1s}).memory;
  for (int k = 0; k < 250; ++k)
    memory = law.advance(memory, K(model, x, 0.002, none), 0.002, Opposition::none);
  CHECK_FALSE(settled(law, memory, K(model, x, 0.002, none), 0.01));
  for (int k = 0; k < 300; ++k)
    memory = law.advance(memory, K(model, x, 0.002, none), 0.002, Opposition::none);
  CHECK(settled(law, memory, K(model, x, 0.002, none), 0.01));
  x.dq[3] = 0.02;
  CHECK_FALSE(settled(law, memory, K(model, x, 0.002, none), 0.01));
}

TEST_CASE("Impedance: joints are springs about their target, gravity once in every sum") {
  JointImpedance<6>::Settings s;
  const JointImpedance<6> law(s);
  using K = Quantities<Arm, Needs{.gravity = true, .mass = true, .middle = true}>;
  State<6> x{0ns, home, {}};
  auto memory = law.start(K(model, x, 0.0, none));
  for (double& q : x.q) q += 0.05;
  const K known(model, x, 0.0, none);
  const auto G = gravity_torque(model, x.q);
  CHECK(largest(law.torque(memory, known) - (G - JointTorque<6>::constant(5))) < 1e-12);
  CHECK(largest(law.torque<GravityTerm::left_out>(memory, known) + JointTorque<6>::constant(5)) < 1e-12);
  CHECK(largest(law.torque(memory, known, LawShare<double>{0.5, 1}) - (G - JointTorque<6>::constant(2.5))) <
        1e-12);
  const auto sum = law + GravityControl{};
  CHECK(largest(sum.torque(sum.start(known), known) - G) < 1e-12);
}

TEST_CASE("Impedance: goals and contacts do not jump, and it arrives") {
  const auto law = cartesian();
  using K = KnownFor<Cartesian>;
  const double dt = 0.002;
  State<6> x{0ns, home, {}};
  auto memory = law.start(K(model, x, dt, none));
  const auto X = law.space().site(K(model, x, dt, none)).X_BP;
  const Transform<Base, Tool> goal(exp_so3(Xyz<double>{0.2, 0.3, -0.2}) * X.axes(),
                                   X.origin() + Xyz<double>{0.1, 0.1, -0.1});
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const K known(model, x, dt, none);
    auto next = memory;
    if (i == 10) next = law.receive(memory, known, {goal, 2s}).memory;
    if (i == 300) next = law.receive(memory, known, {X, 1s}).memory;
    if (i == 500) next = law.receive(memory, known, {goal, 2s}).memory;
    if (i == 800) next = law.advance(memory, known, 0.0, Opposition::lasting);
    if (i == 1000) next = law.advance(memory, known, 0.0, Opposition::none);
    worst = std::max(worst, largest(law.torque(next, known) - law.torque(memory, known)));
    const auto tau = law.torque(next, known);
    memory = law.advance(next, known, dt, next.held ? Opposition::lasting : Opposition::none);
    x = simulate(model, x, tau, dt, 1);
  }
  CHECK(worst < 1e-9);
  const auto d = law.space().site(K(model, x, dt, none)).X_BP.origin() - goal.origin();
  CHECK(std::sqrt(dot(d, d)) < 1e-3);
}

TEST_CASE("Impedance: negative numbers are refused") {
  JointImpedance<6>::Settings s;
  s.stiffness[2] = -1;
  CHECK_THROWS_AS(JointImpedance<6>{s}, ConfigurationError);
  s = {};
  s.damping[1] = std::nan("");
  CHECK_THROWS_AS(JointImpedance<6>{s}, ConfigurationError);
}
