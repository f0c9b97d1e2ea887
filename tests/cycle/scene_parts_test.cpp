#include <doctest/doctest.h>

#include <memory>
#include <string>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
const RobotConfiguration<6> stated{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
}  // namespace

TEST_CASE("Cycle: what it derives from a description is what the description says") {
  const auto arm = by_position(ur5::Model{}, stated);
  const Cycle scene(arm, ur5_skin<260>(), SkinJointControl{} + GravityControl{});
  CHECK(scene.guard().only().period() == 8ms);
  CHECK(scene.guard().only().longest_interval() == 40ms);
  CHECK(scene.guard().only().limits().velocity() == stated.limits.velocity());
  CHECK(scene.resolver().total_delay() == doctest::Approx(0.016));
  static_assert(!decltype(scene)::governed);
  const Cycle direct(
      by_torque(ur5::Model{}, {.limits = stated.limits, .period = 2ms}, FrictionUncompensated{}),
      GravityControl{});
  static_assert(decltype(direct)::governed, "by torque: limits of position and speed");
}

TEST_CASE("Cycle: a law that disagrees with the description is refused with both numbers, in a sum as well") {
  const auto arm = by_position(ur5::Model{}, stated);
  const auto with = [&](auto change) {
    auto s = tracking_settings(arm);
    change(s);
    return complaint_of(
        [&] { Cycle(arm, ur5_skin<260>(), SplineJoint<6>(s) + SkinJointControl{} + GravityControl{}); });
  };
  CHECK(with([](auto&) {}).empty());
  CHECK(with([](auto& s) { s.dt = 1ms; }) ==
        "skinctl: dt: 1 ms in the law, but in late cycles of the robot's description it is evaluated every "
        "2.5 ms: "
        "tracking_settings(robot) takes it from there");
  // A longest interval that sixteen sub-steps of the law's dt do not cover.
  auto late = stated;
  late.longest_interval = 64ms;
  const auto slow = by_position(ur5::Model{}, late);
  CHECK(complaint_of([&] {
          Cycle(slow, ur5_skin<260>(),
                SplineJoint<6>(tracking_settings(arm)) + SkinJointControl{} + GravityControl{});
        }) ==
        "skinctl: dt: 2.5 ms in the law, but in late cycles of the robot's description it is evaluated every "
        "4 ms: tracking_settings(robot) takes it from there");
  CHECK(complaint_of([&] {
          Cycle(slow, ur5_skin<260>(),
                SplineJoint<6>(tracking_settings(slow)) + SkinJointControl{} + GravityControl{});
        }).empty());
  CHECK(with([](auto& s) {
          s.virtual_dynamics.damping = 0;
        }).find("virtual damping: 0 in the law, 4 in the robot's description") != std::string::npos);
  CHECK(with([](auto& s) {
          s.virtual_dynamics.viscous[2] = 5;
        }).find("viscous friction: 5 in the law, 0 in the robot's description") != std::string::npos);
}

TEST_CASE("Cycle::with: limits by name, the guard brakes within the same jerk, settings of the guard go on") {
  const auto arm = by_position(ur5::Model{}, stated);
  const Cycle plain(arm, ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
  const auto scene =
      plain.with(MaxJerk{JointJerk<6>::constant(300)}, GuardSettings<6>{.consent = Reason::state_stale});
  CHECK(scene.governor().get<JerkLimit>().jerk()[0] == 300);
  CHECK(scene.guard().settings().consent == Status(Reason::state_stale));
  static_assert(std::remove_cvref_t<decltype(scene.guard())>::smooth);
  const auto later = scene.with(MaxToolSpeed<5>{.speed = 0.1, .reach = 1.3});
  CHECK(later.governor().get<MaxToolSpeed<5>>().limit() == 0.1);
  CHECK(later.guard().settings().consent == Status(Reason::state_stale));
  CHECK(complaint_of([&] {
          static_cast<void>(plain.with(MaxJerk{JointJerk<6>::constant(-1)}));
        }).find("jerk limit = -1") != std::string::npos);
  const auto both = plain.with(
      LinkContact<2>{.region = {.force = 80, .blow = 120, .first = 100ms, .stiffness = 2e4, .mass = 4},
                     .reach = 0.5,
                     .reaction_time = 20ms},
      LinkContact<3>{.region = {.force = 80, .blow = 120, .first = 100ms, .stiffness = 2e4, .mass = 4},
                     .reach = 0.4,
                     .reaction_time = 20ms});
  CHECK(std::remove_cvref_t<decltype(both.governor().get<LinkContacts>())>::count == 2);
}

TEST_CASE("Cycle::without: takes a part out by its settings or its kind, and then another one fits") {
  const auto arm = by_position(ur5::Model{}, stated);
  const Cycle plain(arm, ur5_skin<260>({.force = 20}), SkinJointControl{} + GravityControl{});
  const auto both =
      plain.with(MaxJerk{JointJerk<6>::constant(300)}, MaxToolSpeed<5>{.speed = 0.1, .reach = 1.3});
  const auto one = both.without<ToolSpeedLimit>();
  CHECK(std::is_same_v<std::remove_const_t<decltype(one)>,
                       decltype(plain.with(MaxJerk{JointJerk<6>::constant(300)}))>);
  CHECK(std::is_same_v<decltype(both.without<MaxToolSpeed<5>>()), std::remove_const_t<decltype(one)>>);
  const auto other = one.with(MaxToolSpeed<4>{.speed = 0.2, .reach = 1.3});
  CHECK(other.governor().get<ToolSpeedLimit>().limit() == 0.2);
  CHECK(other.governor().get<JerkLimit>().jerk()[0] == 300);
  CHECK(std::is_same_v<decltype(one.without<JerkLimit>()), std::remove_const_t<decltype(plain)>>);
}

TEST_CASE("A robot that holds gravity: its torques leave G out, and it stays where it is, stopped too") {
  const ur5::Model model;
  const auto arm = by_torque(model, {.limits = limits_of<ur5::Description>(), .period = 2ms},
                             RobotHoldsGravity{}, FrictionUncompensated{});
  const Cycle scene(arm, SplineJoint(arm));
  const auto memory = std::make_unique<decltype(scene)::Memory>();
  State<6> x{0ns, {0.0, -1.2, 1.4, -1.8, -1.57, 0.3}, {}};
  const auto home = x.q;
  scene.start(*memory, x);
  double largest = 0, away = 0;
  for (int k = 1; k <= 1000; ++k) {
    decltype(scene)::Input input;
    input.now = x.time = k * 2ms;
    input.measured = x;
    if (k == 500) input.request = CycleRequest::stop;
    const auto out = scene.step(*memory, input);
    for (std::size_t i = 0; i < 6; ++i) {
      largest = std::max(largest, std::abs(out.command.torque[i]));
      away = std::max(away, std::abs(x.q[i] - home[i]));
    }
    // The robot's own controller adds what it holds.
    x = simulate(model, x, out.command.torque + gravity_torque(model, x.q), 0.002);
  }
  CHECK(largest < 1e-6);
  CHECK(away < 1e-6);
  CHECK(std::abs(gravity_torque(model, home)[1]) > 10);
}
