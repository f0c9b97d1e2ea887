#include "skinctl/guard/guard.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/robot/velocity_and_torque.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/arm_with_finger.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Model3 = ArmWithFingerModel;
using Robot =
    Resolver<Model3, double,
             JointGroups<3, JointGroup<Interface::velocity, 0b011>, JointGroup<Interface::torque, 0b100>>>;

// Pulls the arm and the finger along.
struct Pull {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  JointTorque<3> tau;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<3> torque(const Memory&, const K& known) const noexcept {
    return tau + gravity_torque(known.model(), known.q());
  }
  template <class K>
  Memory advance(const Memory&, const K&, double, Opposition) const noexcept {
    return {};
  }
};

template <std::size_t N>
JointLimits<N> limits(double torque) {
  return JointLimits<N>({.lower = JointPosition<N>::constant(-3),
                         .upper = JointPosition<N>::constant(3),
                         .velocity = JointVelocity<N>::constant(3),
                         .acceleration = JointAcceleration<N>::constant(40),
                         .torque = JointTorque<N>::constant(torque)});
}
auto scene(const Pull& law) {
  RobotConfiguration<2> arm{.limits = limits<2>(150), .period = 4ms, .delay = 4ms, .virtual_damping = 0};
  arm.viscous_friction = {10, 10};
  const Robot robot =
      resolver_of(by_velocity_and_torque<0b100>(Model3{}, {.stiff = arm, .limits = limits<1>(0.7)}));
  return Cycle(robot, law).template without<MotionByTorque>();
}
using Scene = decltype(scene(Pull{}));
static_assert(std::is_trivially_copyable_v<Scene::Memory>);

// The arm does what it is told a cycle later, the finger stays where it is.
struct Run {
  Scene scene;
  State<3> measured{0ns, {0.2, 0.3, 0.5}, {}};
  Scene::Memory memory = scene.start(measured);
  JointVelocity<3> sent{}, under_way{};

  Scene::Output cycle(CycleRequest request = CycleRequest::none, Status observed = {}) {
    measured.time += 4ms;
    for (std::size_t i = 0; i < 2; ++i) {
      measured.q[i] += 0.004 * under_way[i];
      measured.dq[i] = under_way[i];
    }
    under_way = sent;
    Scene::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.request = request;
    input.observed = observed;
    const auto out = scene.step(memory, input);
    sent = out.command.velocity;
    return out;
  }
};

}  // namespace

TEST_CASE("Guard of groups: a good command passes, with both parts; nothing is allocated") {
  Run run{scene({{4, 2, 0.05}})};
  const AllocationGuard guard;
  Scene::Output out;
  bool passes = true;
  for (int k = 0; k < 200; ++k) {
    out = run.cycle();
    passes = passes && out.status == Status{};
  }
  const auto allocated = guard.count();
  CHECK(allocated == 0);
  CHECK(passes);
  CHECK(out.command.valid);
  CHECK(Robot::stiff(out.command).velocity[0] == doctest::Approx(4.0 / 10).epsilon(0.05));
  CHECK(Robot::torque(out.command)[0] ==
        doctest::Approx(0.05 + gravity_torque(Model3{}, run.scene.resolver().state(run.memory.robot).q)[2]));
}

TEST_CASE("Guard of groups: a torque turns at its rate and ends at its limit, the arm is not disturbed") {
  Run run{scene({{4, 2, 5}})};  // 0.7 N m at most, 35 N m/s
  Run free{scene({{4, 2, 0}})};
  double last = run.memory.robot.command().torque[2];
  for (int k = 0; k < 100; ++k) {
    const auto out = run.cycle(), other = free.cycle();
    CHECK(std::abs(out.command.torque[2] - last) <= 50 * 0.7 * 0.004 * (1 + 1e-9));
    CHECK(std::abs(out.command.torque[2]) <= 0.7);
    CHECK(out.command.velocity == other.command.velocity);
    last = out.command.torque[2];
  }
  CHECK(last == 0.7);
}

TEST_CASE("Guard of groups: bad news of a part, and a stop, hold both without a step") {
  Run run{scene({{10, 5, 0.05}})};
  for (int k = 0; k < 100; ++k) run.cycle();
  CHECK(run.sent[0] > 0.5);
  JointCommand<3> last = run.memory.robot.command();
  const auto steady = [&](const Scene::Output& out) {
    for (std::size_t i = 0; i < 2; ++i)
      CHECK(std::abs(out.command.velocity[i] - last.velocity[i]) <= 40 * 0.004 * (1 + 1e-9));
    CHECK(std::abs(out.command.torque[2] - last.torque[2]) <= 50 * 0.7 * 0.004 * (1 + 1e-9));
    last = out.planned;
  };
  // News of a joint that cannot be: the finger alone.
  const double finger = run.measured.q[2];
  run.measured.q[2] = std::numeric_limits<double>::quiet_NaN();
  Status seen;
  for (int k = 0; k < 100; ++k) {
    const auto out = run.cycle();
    steady(out);
    seen |= out.status;
  }
  CHECK(seen.has(Reason::state_not_finite));
  CHECK(seen.has(Reason::state_stale));
  CHECK(std::abs(run.sent[0]) < 1e-9);
  run.measured.q[2] = finger;
  for (int k = 0; k < 100; ++k) steady(run.cycle(CycleRequest::resume));
  CHECK(run.sent[0] > 0.5);
  for (int k = 0; k < 100; ++k) steady(run.cycle(CycleRequest::stop));
  CHECK(std::abs(run.sent[0]) < 1e-9);
  CHECK(last.torque[2] == doctest::Approx(gravity_torque(Model3{}, run.measured.q)[2]).epsilon(0.01));
}

TEST_CASE("Guard of groups: a state that is not finite starts nothing") {
  Run run{scene({})};
  run.measured.q[0] = std::numeric_limits<double>::infinity();
  run.memory = run.scene.start(run.measured);
  run.measured.q[0] = 0.2;
  CHECK_FALSE(run.cycle().command.valid);
}
