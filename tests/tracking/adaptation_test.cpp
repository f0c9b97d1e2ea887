#include "skinctl/tracking/adaptation.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
using Learning = Adaptive<SplineJoint<6>>;
using K = Quantities<Arm, Learning::needs>;
static_assert(Law<Learning, K>);
static_assert(std::is_trivially_copyable_v<Learning::Memory>);
}  // namespace

TEST_CASE(
    "Adaptive: with masses that the model does not know, the error falls and the estimate stays bounded") {
  const double dt = 0.004;
  const JointControlSettings<6> s{
      .dt = nanoseconds(dt), .lambda = 30, .K_i1 = 0, .K_i2 = 0, .tb = 0s, .K_c = 5};
  const auto bound = deviations(model, 0.5);
  // All masses and inertias are 30 % more than the model knows.
  const auto known_numbers = calibrated_from<ur5::Description, double>();
  auto links = CalibratedModel<ur5::Description>::Links{};
  for (std::size_t i = 0; i < 6; ++i) {
    links[i] = known_numbers.link(i);
    for (const auto p : {LinkParameter::mass, LinkParameter::s_xx, LinkParameter::s_yy, LinkParameter::s_zz,
                         LinkParameter::s_xy, LinkParameter::s_xz, LinkParameter::s_yz})
      links[i][p] *= 1.3;
  }
  const CalibratedModel<ur5::Description> heavier(links);
  const auto error_of = [&](double gamma) {
    const Learning law(SplineJoint<6>(s), {gamma, bound});
    State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
    auto memory = law.start(K(model, x, dt, none));
    double late = 0;
    for (int i = 0; i < 5000; ++i) {
      const K known(model, x, dt, none);
      if (i % 500 == 0) {
        const double way = i % 1000 == 0 ? 0.5 : -0.5;
        JointPosition<6> goal{0.3 + way, -1.2 + 0.6 * way, 1.4 - way, -1.8 + way, -1.4 + way, 0.3};
        memory = law.receive(memory, known, {goal, 1500ms}).memory;
      }
      const auto now = law.now(memory, known);
      if (i > 4000)
        for (std::size_t j = 0; j < 6; ++j) late = std::max(late, std::abs(now.S_q[j]));
      const auto tau = law.torque(memory, known);
      memory = law.advance(memory, known, dt, Opposition::none);
      for (std::size_t k = 0; k < 60; ++k) REQUIRE(std::abs(memory.deviation.data[k]) <= bound.data[k]);
      x = simulate(heavier, x, tau, dt, 1);
    }
    return late;
  };
  const double without = error_of(0), with = error_of(2);
  MESSAGE("largest S_q late in the motion: " << without << " rad/s without, " << with << " with adaptation");
  CHECK(with < 0.4 * without);
}

TEST_CASE("Adaptive: stands still against the skin and before numbers that are none") {
  const Learning law(SplineJoint<6>({.dt = 4ms}), {2.0, deviations(model, 0.5)});
  State<6> x{0ns, JointPosition<6>::constant(0.5), {}};
  auto memory = law.start(K(model, x, 0.004, none));
  memory = law.receive(memory, K(model, x, 0.004, none), {JointPosition<6>{}, 1s}).memory;
  x.dq = JointVelocity<6>::constant(0.3);
  const K known(model, x, 0.004, none);
  const auto held = law.advance(memory, known, 0.004, Opposition::lasting);
  for (const double d : held.deviation.data) CHECK(d == 0.0);
  const auto moved = law.advance(memory, known, 0.004, Opposition::none);
  CHECK(moved.deviation(1, Inertial::h_x) != 0.0);
  x.q[2] = std::nan("");
  const auto odd = law.advance(moved, K(model, x, 0.004, none), 0.004, Opposition::none);
  for (const double d : odd.deviation.data) CHECK(std::isfinite(d));
  auto bad = deviations(model, 0.5);
  bad.data[3] = -1;
  CHECK_THROWS_AS(Learning(SplineJoint<6>({.dt = 4ms}), {1.0, bad}), ConfigurationError);
}

TEST_CASE("Adaptive: a streamed target is followed as the law alone follows it") {
  const JointControl<6> alone({.dt = 4ms});
  const Adaptive<JointControl<6>> law(alone, {0.0, deviations(model, 0.5)});
  State<6> x{0ns, JointPosition<6>::constant(0.5), {}};
  auto memory = law.start(K(model, x, 0.004, none));
  auto plain = alone.start(K(model, x, 0.004, none));
  JointTorque<6> first{}, last{};
  for (int k = 0; k < 100; ++k) {
    const K known(model, x, 0.004, none);
    const JointControl<6>::Goal sample{
        JointPosition<6>::constant(0.5 + 0.002 * k), JointVelocity<6>::constant(0.5), {}};
    memory = law.follow(memory, known, sample).memory;
    plain = alone.follow(plain, known, sample).memory;
    memory = law.advance(memory, known, 0.004, Opposition::none);
    plain = alone.advance(plain, known, 0.004, Opposition::none);
    last = law.torque(memory, known);
    if (k == 0) first = last;
    const auto expected = alone.torque(plain, known);
    for (std::size_t i = 0; i < 6; ++i) CHECK(last[i] == expected[i]);
  }
  CHECK_FALSE(first == last);
}
