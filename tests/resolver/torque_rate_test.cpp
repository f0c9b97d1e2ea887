// The torque that laws ask for by themselves turns at a bounded rate, what answers touch at once.
//
// Promise: the torque that laws ask for by themselves turns at a bounded rate; what answers touch is not
// delayed
// Tried: by position, velocity, torque: 50 torque limits a second, reported as `torque_limited`

#include "skinctl/resolver/detail/torque_rate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;

/// 20 N m on the shoulder and 5 on the wrist, to and fro every 40 ms.
template <LawRole R>
struct Jumps : Composable {
  struct Memory {};
  static constexpr Needs needs{.gravity = R == LawRole::tracking};
  static constexpr LawRole role = R;
  static JointTorque<6> own(Nanoseconds time) {
    const double side = time / 40ms % 2 == 0 ? 1 : -1;
    return {0, 20 * side, 0, 0, 5 * side, 0};
  }
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<6> torque(const Memory&, const K& known) const noexcept
    requires(R == LawRole::reactive)
  {
    return own(known.time());
  }
  template <class K>
  TorqueParts<6> parts(const Memory&, const K& known) const noexcept
    requires(R == LawRole::tracking)
  {
    return {own(known.time()), {}};
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

constexpr auto any_torque = [](const JointTorque<2>&) { return false; };  ///< no limit
struct TwoParts {
  static constexpr std::size_t terms = 2;
  static constexpr std::array<LawRole, 2> roles{LawRole::tracking, LawRole::reactive};
};

struct Seen {
  double fastest = 0;  ///< change of torque in a cycle over what the limits allow
  int limited = 0;
};
/// 100 cycles of 2 ms on an arm that stays where it is.
template <class Robot, class L>
Seen run(const Robot& arm, const L& law) {
  const Cycle scene(arm, law);
  State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
  auto memory = scene.start(x);
  Seen seen;
  JointTorque<6> last;
  for (int k = 1; k <= 100; ++k) {
    typename decltype(scene)::Input input;
    x.time = input.now = k * 2ms;
    input.measured = x;
    const auto out = scene.step(memory, input);
    seen.limited += out.status.has(Reason::torque_limited);
    for (std::size_t i = 0; k > 1 && i < 6; ++i)
      seen.fastest = std::max(
          seen.fastest, std::abs(out.planned.torque[i] - last[i]) / (50 * 0.002 * arm.limits().torque()[i]));
    last = out.planned.torque;
  }
  return seen;
}
const RobotConfiguration<6> configuration{
    .limits = limits_of<ur5::Description>(), .period = 2ms, .virtual_damping = 0};
template <class F>
void for_each_robot(F&& f) {
  f(by_position(Arm{}, configuration));
  f(by_velocity(Arm{}, configuration));
  f(by_torque(Arm{}, configuration, FrictionUncompensated{}));
}
}  // namespace

TEST_CASE("torque rate: a tracking law that jumps is turned at the rate of the description, and it is said") {
  for_each_robot([](const auto& arm) {
    const Seen seen = run(arm, Jumps<LawRole::tracking>{} + GravityControl{});
    CHECK(seen.fastest <= 1.02);  // gravity of a virtual arm that moves
    CHECK(seen.fastest >= 0.9);
    CHECK(seen.limited >= 3);  // at each jump but the first
    CHECK(seen.limited <= 20);
  });
}

TEST_CASE("torque rate: a reactive law is not delayed") {
  const Seen by_position_ =
      run(by_position(Arm{}, configuration), Jumps<LawRole::reactive>{} + GravityControl{});
  CHECK(by_position_.limited == 0);
  CHECK(by_position_.fastest > 2.5);
}

TEST_CASE("torque rate: the first torque passes, within the rate all pass to the bit") {
  using L = Jumps<LawRole::tracking>;
  detail::OwnTorque<2, double> own;
  const JointTorque<2> step{1, 0.1};
  const auto bound = [&](JointTorque<2> tau, bool acts) {
    JointTorque<2> kept = tau;
    CHECK(own.bound<L>(std::array<JointTorque<2>, 1>{tau}, step, any_torque, kept) == acts);
    return kept;
  };
  CHECK(bound({50, 50}, false) == JointTorque<2>{50, 50});
  CHECK(bound({50.9, 49.95}, false) == JointTorque<2>{50.9, 49.95});
  CHECK(bound({60, 49.95}, true) == JointTorque<2>{51.9, 49.95});
  CHECK(bound({60, 40}, true)[1] == doctest::Approx(49.85));
  // The law's own part gives way to a reactive one: the whole stays.
  detail::OwnTorque<2, double> beside;
  JointTorque<2> whole{10, 1};
  CHECK_FALSE(beside.bound<TwoParts>(std::array<JointTorque<2>, 2>{whole, {}}, step, any_torque, whole));
  CHECK_FALSE(
      beside.bound<TwoParts>(std::array<JointTorque<2>, 2>{{{-20, -2}, {30, 3}}}, step, any_torque, whole));
  CHECK(whole == JointTorque<2>{10, 1});
  // A touch passes, the law's own jump beside it does not.
  whole = {150, 1};
  CHECK(beside.bound<TwoParts>(std::array<JointTorque<2>, 2>{{{20, -2}, {130, 3}}}, step, any_torque, whole));
  CHECK(whole == JointTorque<2>{111, 1});
  auto c = configuration;
  c.torque_rate = 0;
  CHECK_THROWS_AS(static_cast<void>(by_position(Arm{}, c)), ConfigurationError);
}

namespace {
/// 35 times what a wrist gives, to and fro every 100 ms.
struct AsksForMuch : Jumps<LawRole::tracking> {
  template <class K>
  TorqueParts<6> parts(const Memory&, const K& known) const noexcept {
    return {{0, 0, 0, 0, known.time() / 100ms % 2 == 0 ? 1000.0 : -1000.0, 0}, {}};
  }
};
}  // namespace

TEST_CASE("torque rate: from one limit to the other in the time of the rate, however much a law asks for") {
  for_each_robot([](const auto& arm) {
    const Cycle scene(arm, AsksForMuch{} + GravityControl{});
    State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
    auto memory = scene.start(x);
    int turned = 0;  // cycles of 2 ms until the torque has the new sign
    for (int k = 1; k < 100; ++k) {
      typename decltype(scene)::Input input;
      x.time = input.now = k * 2ms;
      input.measured = x;
      const auto out = scene.step(memory, input);
      if (k >= 50 && out.planned.torque[4] > 0) turned = k - 49;
    }
    CHECK(turned >= 8);  // a limit in 20 ms
    CHECK(turned <= 12);
  });
}

TEST_CASE(
    "torque rate: what no joint gives is cut off first, so that a law that asks for far more turns round at "
    "once") {
  // An arm that was held is let go far from its goal. With the rate before the limit it swung about the goal
  // for ever.
  const ur5::Model model;
  for (const double held : {0.2, 0.6}) {
    CAPTURE(held);
    RobotConfiguration<6> c{
        .limits = limits_of<ur5::Description>(15.0), .period = 500us, .lag = 20ms, .virtual_damping = 5};
    c.virtual_inertia = JointTorque<6>::constant(4.7);
    const auto arm = by_position(model, c);
    const Cycle scene(arm, SplineJoint(arm) + GravityControl{});
    using Scene = std::remove_const_t<decltype(scene)>;
    const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};
    JointPosition<6> goal = home;
    goal[4] -= held;
    SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, 0, 0.02, std::to_array(home.data));
    const auto memory = std::make_unique<Scene::Memory>();
    scene.start(*memory, {0ns, home, {}});
    double fastest = 0;
    for (int k = 1; k <= 20'000; ++k) {
      const double t = 5e-4 * k;
      joints.hold_fast(4, t < 2);
      joints.advance(t);
      Scene::Input input;
      input.now = input.measured.time = k * 500us;
      for (std::size_t i = 0; i < 6; ++i)
        input.measured.q[i] = joints.q()[i], input.measured.dq[i] = joints.dq()[i];
      if (k == 1) input.goal = {goal, 1s};
      const auto out = scene.step(*memory, input);
      REQUIRE(out.command.valid);
      joints.command(t, std::to_array(out.command.position.data));
      if (t > 9) fastest = std::max(fastest, std::abs(out.planned.velocity[4]));
    }
    CHECK(std::abs(joints.q()[4] - goal[4]) < 1e-3);
    CHECK(fastest < 1e-3);
  }
}
