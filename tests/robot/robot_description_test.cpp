// Promise: a fact that is stated twice and differs is refused with both numbers
// Tried: limits, period, delay, virtual dynamics, dt; gravity or friction held twice or by nobody. Also:
// `cycle/`, `compile_fail/cycle`

#include <doctest/doctest.h>

#include <string>

#include "skinctl/skinctl.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;

namespace {
auto arm() {
  return by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0),
                                    .period = 8ms,
                                    .delay = 6ms,
                                    .lag = 2ms,
                                    .virtual_damping = 4});
}
}  // namespace

TEST_CASE("RobotDescription: says how often laws are evaluated, as planned and when a cycle is late") {
  CHECK(arm().dt() == 2ms);
  CHECK(arm().longest_dt() == 2500us);  // five periods in sixteen sub-steps
  CHECK(arm().configuration().total_delay() == 16ms);
  const auto fast = by_velocity(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(), .period = 1ms, .delay = 2ms, .virtual_damping = 4});
  CHECK(fast.dt() == 1ms);
  CHECK(fast.longest_dt() == 1ms);
  const auto direct = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(), .period = 2ms});
  CHECK(direct.dt() == 2ms);
  CHECK(direct.longest_dt() == 2ms);
}

TEST_CASE(
    "RobotDescription: the delay of a law's loop is that of the robot by torque, a sub-step of a virtual "
    "one") {
  CHECK(arm().loop_delay() == arm().longest_dt());
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(), .period = 2ms, .delay = 8ms, .lag = 1ms};
  CHECK(by_torque(ur5::Model{}, c).loop_delay() == 12ms);
  c.longest_interval = 40ms;  // a torque is held as long as the cycle is late, which is no plan
  CHECK(by_torque(ur5::Model{}, c).loop_delay() == 12ms);
}

TEST_CASE("RobotDescription: knows its parts by their types") {
  const auto kept = by_position(ur5::Model{}, arm().configuration(), EnergyTank<>({.start = 2}));
  static_assert(decltype(kept)::has<EnergyTank<>> && !decltype(arm())::has<EnergyTank<>>);
  CHECK(std::get<0>(kept.parts()).settings().start == 2);
  const auto held =
      by_torque(ur5::Model{}, arm().configuration(), RobotHoldsGravity{}, FrictionUncompensated{});
  static_assert(decltype(held)::robot_holds_gravity && decltype(held)::friction_uncompensated);
  static_assert(!decltype(held)::robot_compensates_friction);
}

TEST_CASE("RobotDescription: numbers that cannot be are refused where it is built") {
  auto c = arm().configuration();
  c.period = 2s;
  CHECK(skinctl::testing::complaint_of([&] { static_cast<void>(by_position(ur5::Model{}, c)); }) ==
        "skinctl: period = 2000, allowed: 0.1 to 1000 ms");
  c.period = 8ms;
  c.virtual_damping = -1;
  CHECK(skinctl::testing::complaint_of([&] { static_cast<void>(by_velocity(ur5::Model{}, c)); }) ==
        "skinctl: virtual damping = -1, allowed: 0 to 1e4 1/s");
}

TEST_CASE(
    "RobotDescription: how fast free motion dies out is said, or refused where there is a virtual robot") {
  auto c = arm().configuration();
  c.virtual_damping.reset();
  const auto by_groups_of = [](const auto& one) {
    static_cast<void>(by_groups(ur5::Model{}, position_joints<0b111111>(one)));
  };
  const std::string expected = "skinctl: virtual damping: left out, allowed: 0 to 1e4 1/s; 4 to 10 is usual";
  CHECK(skinctl::testing::complaint_of([&] { static_cast<void>(by_position(ur5::Model{}, c)); }) == expected);
  CHECK(skinctl::testing::complaint_of([&] { static_cast<void>(by_velocity(ur5::Model{}, c)); }) == expected);
  CHECK(skinctl::testing::complaint_of([&] { by_groups_of(c); }) == expected);
  CHECK(skinctl::testing::complaint_of([&] { static_cast<void>(by_torque(ur5::Model{}, c)); }).empty());
  CHECK(by_torque(ur5::Model{}, c).virtual_dynamics().damping == 0);
  c.virtual_damping = 0;  // friction of the joints or of the tool instead
  CHECK(skinctl::testing::complaint_of([&] { static_cast<void>(by_position(ur5::Model{}, c)); }).empty());
  CHECK(skinctl::testing::complaint_of([&] { by_groups_of(c); }).empty());
}

TEST_CASE("tracking_settings: times, virtual dynamics and speeds are the robot's") {
  auto c = arm().configuration();
  c.viscous_friction = JointTorque<6>::constant(3);
  const auto s = tracking_settings(by_position(ur5::Model{}, c));
  CHECK(s.dt == 2500us);
  CHECK(s.lambda == doctest::Approx(0.25 / 0.0025));
  CHECK(s.virtual_dynamics.damping == 4);
  CHECK(s.virtual_dynamics.viscous[5] == 3);
  auto slow = limits_of<ur5::Description>(15.0).values();
  slow.velocity[2] = 0.5;
  c.limits = JointLimits<6>(slow);
  const auto t = tracking_settings(by_position(ur5::Model{}, c));
  CHECK(t.max_velocity[2] == 0.5);
  CHECK(t.max_velocity[1] == 1);
  CHECK(tracking_settings(by_position<float>(ur5::Model{}, {.limits = limits_of<ur5::Description, float>(),
                                                            .period = 8ms,
                                                            .virtual_damping = 2}))
            .virtual_dynamics.damping == 2.0f);
}

TEST_CASE(
    "tracking_settings: by torque they follow the delay and the lightest robot, and are always accepted") {
  struct Loop {
    Nanoseconds period, delay;
  };
  for (const auto& loop : {Loop{100us, 0us}, {1ms, 6ms}, {2ms, 12ms}, {8ms, 20ms}, {8ms, 300ms}})
    for (const double ratio : {1.0, 1.9, 2.5, 4.0}) {
      CAPTURE(loop.delay.count());
      CAPTURE(ratio);
      const auto robot =
          by_torque(ur5::Model{},
                    {.limits = limits_of<ur5::Description>(), .period = loop.period, .delay = loop.delay});
      const auto s = tracking_settings(robot, ratio);
      const double D = seconds<double>(loop.delay + 3 * loop.period / 2);
      CHECK(s.lambda == doctest::Approx(0.3 / (D * std::max(1.0, ratio / 2))));
      CHECK(s.mass_ratio == ratio);
      CHECK_NOTHROW(check(s, s.lambda));
      CHECK_NOTHROW(SplineJoint<6>{s});
    }
  const auto robot =
      by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(), .period = 2ms, .delay = 2ms});
  const auto fast = tracking_settings(robot);  // D = 5 ms: lambda = 60 1/s
  CHECK(fast.K_c == 10);
  CHECK(fast.K_i1 == 10);
  CHECK(fast.K_i2 == doctest::Approx(60.0 / 80));
  CHECK(fast.tb == 0s);
  CHECK(fast.integral_limit[0] > 60);
  CHECK(fast.integral_limit[5] < 0.1);  // the last link alone: its motor is not declared
  auto with_motors = robot.configuration();
  with_motors.virtual_inertia = JointTorque<6>::constant(0.1);
  CHECK(tracking_settings(by_torque(ur5::Model{}, with_motors)).integral_limit[5] == 14);
  const auto slow =
      tracking_settings(by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(), .period = 8ms}));
  CHECK(slow.K_c == doctest::Approx(0.25 * 0.3 / 0.012));
  CHECK(slow.K_i1 == slow.K_c);
  CHECK_NOTHROW(Cycle(by_torque(ur5::Model{}, robot.configuration(), FrictionUncompensated{}),
                      SplineJoint<6>(fast) + GravityControl{}));
  // A law made for no robot by torque, or for another delay.
  CHECK(skinctl::testing::complaint_of([&] {
          auto c = robot.configuration();
          c.delay = 3ms;
          Cycle(by_torque(ur5::Model{}, c, FrictionUncompensated{}), SplineJoint<6>(fast) + GravityControl{});
        }) ==
        "skinctl: loop_delay: 5 ms in the law, 6 ms by the robot's description: tracking_settings(robot) "
        "takes it "
        "from there");
  CHECK(operational_settings(robot, 2.0).tracking.mass_ratio == 2);
}

namespace {
struct Weak : ur5::Description {
  static constexpr double max_torque = 10;
};
}  // namespace

TEST_CASE("RobotDescription: the limits of another robot are refused where they are beyond its own") {
  const auto with = [](const auto& model, const JointLimits<6>& limits) {
    return skinctl::testing::complaint_of([&] {
      static_cast<void>(by_position(model, {.limits = limits, .period = 8ms, .virtual_damping = 4}));
    });
  };
  const auto of_ur10 = limits_of<ur10::Description>(15.0), of_ur5 = limits_of<ur5::Description>(15.0);
  const std::string strong =
      "skinctl: torque limit of joint 0 = 330, allowed: <= 150, the model's own: these are the limits of "
      "another robot; JointLimits(limits.values()) insists";
  CHECK(with(ur5::Model{}, of_ur10) == strong);
  CHECK(with(Loaded<ur5::Model, 5>(ur5::Model{}), of_ur10) == strong);
  CHECK(with(calibrated_from<ur10::Description>(), of_ur5)
            .starts_with("skinctl: velocity limit of joint 0 = "));
  CHECK(with(ur10::Model{}, of_ur5).starts_with("skinctl: "));
  // Its own, those that are weaker in all, numbers that are stated, and a model without limits.
  CHECK(with(ur5::Model{}, of_ur5).empty());
  CHECK(with(ur10::Model{}, limits_of<ur10::Description>()).empty());
  CHECK(with(ur5::Model{}, JointLimits<6>(of_ur10.values())).empty());
  CHECK(with(ur5::Model{}, limits_of<Weak>()).empty());
}

TEST_CASE("Laws of a described robot have its settings") {
  const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1);
  const SplineJoint joint(arm());
  static_assert(std::is_same_v<decltype(joint), const SplineJoint<6>>);
  CHECK(joint.settings().virtual_dynamics.damping == 4);
  const SplineOperational tool(arm(), X_LT);
  static_assert(std::is_same_v<decltype(tool), const SplineOperational<6, 5>>);
  CHECK(tool.settings().tracking.dt == 2500us);
  const ForceControl press(arm(), X_LT);
  CHECK(press.settings().pose.tracking.virtual_dynamics.damping == 4);
  CHECK(press.settings().carried == 0);
  CHECK(ForceControl(by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(), .period = 2ms}), X_LT)
            .settings()
            .carried == 1);
}
