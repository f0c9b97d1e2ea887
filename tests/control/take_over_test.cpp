#include "skinctl/control/take_over.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
using Reach6 = TakeOver<6, SplineJoint<6>>;
using KnownAt = Quantities<Arm, Needs{.middle = true}, double>;
static_assert(Law<Reach6, KnownAt> && terms_of<Reach6> == 2);
static_assert(std::is_trivially_copyable_v<Reach6::Memory>);
const Arm model;
const NoTouch none;
}  // namespace

TEST_CASE("TakeOver: begins with the torque that was there, and ends with the law's own") {
  const auto law = take_over<6>(SplineJoint<6>({.dt = 2ms}));
  const State<6> x{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.0}, {}};
  const KnownAt known(model, x, 0.002, none);
  const JointTorque<6> before{5.0, -60.0, 10.0, 1.0, -1.0, 0.5};
  auto memory = law.start(known, before);
  auto last = law.torque(memory, known);
  for (std::size_t i = 0; i < 6; ++i) CHECK(last[i] == doctest::Approx(before[i]).epsilon(1e-14));
  for (int k = 0; k < 60; ++k) {
    const auto e = evaluate(law, memory, known, 0.002);
    CHECK(e.status.has(Reason::bumpless_transfer) == (k < 50));
    JointTorque<6> sum;
    for (const auto& share : e.shares) sum += share;
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(sum[i] == doctest::Approx(e.torque[i]).epsilon(1e-14));
      CHECK(magnitude(e.torque[i] - last[i]) <= 1.875 / 50 * 1.01 * 66);
    }
    CHECK(e.torque == law.torque(memory, known));
    last = e.torque;
    memory = e.memory;
  }
  CHECK(last == law.law().torque(memory.law, known));
  CHECK(law.torque(law.start(known), known) == law.law().torque(law.law().start(known), known));
}

TEST_CASE("TakeOver: carries out what a changed memory would make jump") {
  const auto law = take_over<6>(GravityControl{});
  const State<6> x{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.0}, {}};
  const KnownAt known(model, x, 0.002, none);
  auto memory = law.start(known, JointTorque<6>::constant(3));
  for (int k = 0; k < 20; ++k) memory = law.advance(memory, known, 0.002, Opposition::none);
  const auto before = law.torque(memory, known);
  const auto next = law.changed(memory, known, law.law().start(known));
  const auto after = law.torque(next, known);
  for (std::size_t i = 0; i < 6; ++i) CHECK(after[i] == doctest::Approx(before[i]).epsilon(1e-13));
}

TEST_CASE("TakeOver: a torque that is not finite counts as none") {
  const auto law = take_over<6>(GravityControl{});
  const State<6> x{};
  const KnownAt known(model, x, 0.002, none);
  JointTorque<6> before;
  before[2] = std::numeric_limits<double>::quiet_NaN();
  const auto memory = law.start(known, before);
  for (const double tau : law.torque(memory, known)) CHECK(tau - tau == 0);
}

TEST_CASE("TakeOver: passes goals and opposition on") {
  const auto law = take_over<6>(SplineJoint<6>({.dt = 2ms}));
  const State<6> x{};
  const KnownAt known(model, x, 0.002, none);
  auto memory = law.receive(law.start(known), known, JointGoal<6>{JointPosition<6>::constant(1), 3s}).memory;
  static_assert(std::same_as<decltype(law)::Goal, JointGoal<6>>);
  CHECK(memory.law.plan.spline.tf == 3);
  CHECK(settled(law, memory, known, 0.01) == settled(law.law(), memory.law, known, 0.01));
  memory = law.advance(memory, known, 0.002, Opposition::lasting);
  CHECK(memory.law.held);
}

TEST_CASE("TakeOver: a law without goals works in a scene, in which it is checked") {
  const auto arm = by_position(Arm{}, {.limits = limits_of<ur5::Description>(), .period = 8ms});
  const Cycle scene(arm, take_over<6>(GravityControl{}));
  static_assert(std::same_as<decltype(scene)::Goal, NoGoal>);
  State<6> x{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.0}, {}};
  auto memory = scene.start(x);
  decltype(scene)::Input input;
  input.now = x.time = 8ms;
  input.measured = x;
  const auto out = scene.step(memory, input);
  CHECK(out.command.valid);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out.command.position[i] - x.q[i]) < 1e-12);
}
