#include <doctest/doctest.h>

#include <limits>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robot/velocity_and_torque.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/arm_with_finger.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Mean torques over a sub-step, in the skin's place.
template <std::size_t N, class T>
struct Pushes {
  JointTorque<N, T> torque;
  friend Pushes led_by(const Pushes& touch, const T& share, const Pushes& change) noexcept {
    return {touch.torque + share * change.torque};
  }
};

// Yields to what pushes, and holds the joints of `set` softly at `goal`. Counts its evaluations.
template <std::size_t N, class T = double>
struct Grasp {
  struct Memory {
    T seconds = T(0);
  };
  static constexpr Needs needs{.gravity = true, .touch = true};
  static constexpr LawRole role = LawRole::reactive;
  JointPosition<N, T> goal;
  JointTorque<N, T> stiffness, damping;
  T broken = T(0);  // added to every torque

  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<N, T> torque(const Memory&, const K& known) const noexcept {
    auto tau = known.touch().torque + known.gravity();
    for (std::size_t i = 0; i < N; ++i)
      tau[i] += broken + stiffness[i] * (goal[i] - known.q()[i]) - damping[i] * known.dq()[i];
    return tau;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, T dt, Opposition) const noexcept {
    return {m.seconds + dt};
  }
};

using SmallModel = ArmWithFingerModel;
struct Arm {
  static constexpr std::size_t joints = 2;
  static constexpr auto parents = chain_parents<2>();
  static constexpr auto kinds = all_of_kind<2>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 2> links = {ArmWithFinger::links[0],
                                                                  ArmWithFinger::links[1]};
};
using ArmModel = StaticModel<Arm>;
template <Interface I, class T = double>
using SmallRobot =
    Resolver<SmallModel, T, JointGroups<3, JointGroup<I, 0b011, T>, JointGroup<Interface::torque, 0b100, T>>>;
static_assert(std::is_trivially_copyable_v<SmallRobot<Interface::velocity>::Memory>);

template <std::size_t N, class T>
JointLimits<N, T> limits(T torque) {
  return JointLimits<N, T>({.lower = JointPosition<N, T>::constant(T(-3)),
                            .upper = JointPosition<N, T>::constant(T(3)),
                            .velocity = JointVelocity<N, T>::constant(T(3)),
                            .acceleration = JointAcceleration<N, T>::constant(T(40)),
                            .torque = JointTorque<N, T>::constant(torque)});
}

// The arm follows its commands after a delay; the finger is what the equations of motion make of it on an arm
// that moves as commanded.
template <Interface I, class T>
struct SmallScene {
  using Robot = SmallRobot<I, T>;
  static HybridConfiguration<2, 1, T> configuration() {
    RobotConfiguration<2, T> arm{
        .limits = limits<2, T>(T(150)), .period = 4ms, .delay = 8ms, .virtual_damping = 0};
    arm.lag = I == Interface::position ? 4ms : 0ms;
    arm.viscous_friction = JointTorque<2, T>::constant(T(10));
    return {.stiff = arm, .limits = limits<1, T>(T(0.7)), .viscous = JointTorque<1, T>::constant(T(0.002))};
  }
  static Robot made() {
    if constexpr (I == Interface::velocity) {
      return resolver_of(by_velocity_and_torque<0b100, T>(SmallModel{}, configuration()));
    } else {
      const auto c = configuration();
      RobotConfiguration<1, T> finger{.limits = c.limits, .period = c.stiff.period};
      finger.viscous_friction = c.viscous;
      return resolver_of(
          by_groups(SmallModel{}, position_joints<0b011, T>(c.stiff), torque_joints<0b100, T>(finger)));
    }
  }
  Robot robot = made();
  Grasp<3, T> law{
      .goal = {T(0), T(0), T(0.6)}, .stiffness = {T(0), T(0), T(0.4)}, .damping = {T(0), T(0), T(0.02)}};
  typename Grasp<3, T>::Memory law_memory{};
  SimulatedJoints<2> arm{
      I == Interface::position ? SimulatedJoints<2>::Kind::position : SimulatedJoints<2>::Kind::velocity,
      0.008,
      I == Interface::position ? 0.004 : 0.0,
      {0.2, 0.3}};
  State<3, T> measured{0ns, {T(0.2), T(0.3), T(0.5)}, {}};
  typename Robot::Memory memory = robot.start(measured);
  Nanoseconds now{};
  double finger = 0.5, finger_speed = 0;

  auto cycle(const JointTorque<3, T>& push) {
    now += 4ms;
    const double h = 0.0002;
    const double drive = double(memory.command().torque[2]) + double(push[2]);
    for (int k = 1; k <= 20; ++k) {
      arm.advance(seconds<double>(now) - 0.004 + k * h);
      const JointPosition<3> q{arm.q()[0], arm.q()[1], finger};
      const JointVelocity<3> v{arm.dq()[0], arm.dq()[1], finger_speed};
      const double bias = bias_torque(SmallModel{}, JointAngles<SmallModel, double>({}, q), v)[2];
      finger_speed += h * (drive - bias) / mass_matrix(SmallModel{}, q)(2, 2);
      finger += h * finger_speed;
    }
    measured = {
        now, {T(arm.q()[0]), T(arm.q()[1]), T(finger)}, {T(arm.dq()[0]), T(arm.dq()[1]), T(finger_speed)}};
    return resolve(push);
  }
  auto resolve(const JointTorque<3, T>& push) {
    Pushes<3, T> touches[max_substeps];
    for (auto& touch : touches) touch.torque = push;
    auto out = robot.step(memory, law, law_memory, measured, robot.interval(memory, now),
                          std::span<const Pushes<3, T>>(touches));
    SimulatedJoints<2>::Row row;
    const auto stiff = part_of<typename Robot::Stiff>(out.command);
    for (std::size_t i = 0; i < 2; ++i)
      row[i] = double(I == Interface::position ? stiff.position[i] : stiff.velocity[i]);
    arm.command(seconds<double>(now), row);
    return out;
  }
};

template <Interface I, class T>
struct Case {
  static constexpr Interface interface = I;
  using scalar = T;
};

}  // namespace

TEST_CASE(
    "Resolver in groups: the arm moves as by velocity alone with the hand as a load, the hand has its "
    "torque") {
  using Robot = SmallRobot<Interface::velocity>;
  const auto c = SmallScene<Interface::velocity, double>::configuration();
  const Robot robot = SmallScene<Interface::velocity, double>::made();
  State<3> measured{0ns, {0.2, 0.3, 0.5}, {}};
  // The oracle: an arm that carries the finger as a part of itself, in the same pose.
  const auto X = Poses<SmallModel, all_links(3), double>(SmallModel{}, measured.q);
  const auto X_AF = X.get<1>().inverse() * X.get<2>();
  const Loaded<ArmModel, 1> loaded(
      ArmModel{}, seen_from(X_AF.axes(), X_AF.origin(), inertia_of(ArmWithFinger::links[2])));
  const ResolverBy<Interface::velocity, Loaded<ArmModel, 1>> alone(loaded, c.stiff);
  RobotConfiguration<3> direct{.limits = limits<3, double>(1e3), .period = 4ms};
  const ResolverBy<Interface::torque, SmallModel> torques(SmallModel{}, direct);

  const Grasp<3> law{.goal = measured.q, .stiffness = {0.2, 0.2, 0.2}, .damping = {}};
  const Grasp<2> arm_law{.goal = {0.2, 0.3}, .stiffness = {0.2, 0.2}, .damping = {}};
  Grasp<3>::Memory law_memory, torque_law_memory;
  Grasp<2>::Memory arm_memory;
  auto memory = robot.start(measured);
  auto alone_memory = alone.start(part_of<Robot::Stiff>(measured));
  double travel = 0, off = 0, torque_off = 0;
  std::uint64_t allocated = 0;
  for (Nanoseconds now = 4ms; now < 1600ms; now += 4ms) {
    const double t = seconds<double>(now), s = t < 0.8 ? std::sin(4 * t) : 0;
    Pushes<3, double> touches[2];
    Pushes<2, double> arm_touches[2];
    for (std::size_t j = 0; j < 2; ++j) {
      touches[j].torque = {8 * s, -6 * s, 0.05 * s};
      arm_touches[j].torque = {8 * s, -6 * s};
    }
    // The arm does what is declared; the hand is held as it is, but in the last cycle.
    const bool last = now + 4ms >= 1600ms;
    measured.time = now;
    measured.dq[2] = last ? 0.3 : 0;
    Robot::Stiff::put(memory.group().under_way.reached, measured.q);
    const AllocationGuard guard;
    const auto out = robot.step(memory, law, law_memory, measured, robot.interval(memory, now),
                                std::span<const Pushes<3, double>>(touches));
    allocated += guard.count();
    const auto want =
        alone.step(alone_memory, arm_law, arm_memory, {now, alone_memory.group().under_way.reached, {}},
                   alone.interval(alone_memory, now), std::span<const Pushes<2, double>>(arm_touches));
    for (std::size_t i = 0; i < 2 && !last; ++i) {
      off = std::max(off, std::abs(out.command.velocity[i] - want.command.velocity[i]));
      off = std::max(off, std::abs(out.command.position[i] - want.command.position[i]));
      travel = std::max(travel, std::abs(out.command.position[i] - (i == 0 ? 0.2 : 0.3)));
    }
    CHECK(out.status == want.status);
    // The torque interface at the state that the law was asked at.
    auto torque_memory = torques.start({now - 4ms, robot.state(memory).q, robot.state(memory).dq});
    const auto torque = torques.step(torque_memory, law, torque_law_memory, robot.state(memory),
                                     torques.interval(torque_memory, now),
                                     std::span<const Pushes<3, double>>(touches + 1, 1));
    // Of one joint whose arm follows commands: B dq / (1 + D B/M), D = 3/2 h.
    const auto at = robot.state(memory);
    const double m = mass_matrix(SmallModel{}, at.q)(2, 2), b = c.viscous[0];
    const double drag = b / (1 + 1.5 * 0.004 * b / m) * at.dq[2];
    torque_off = std::max(torque_off, std::abs(out.command.torque[2] + drag - torque.command.torque[2]));
  }
  CHECK(travel > 0.2);
  CHECK(off < 1e-12);
  CHECK(torque_off < 1e-12);
  CHECK(allocated == 0);
}

TEST_CASE_TEMPLATE("Resolver in groups: the hand grasps and is pushed while the arm gives way", C,
                   Case<Interface::velocity, double>, Case<Interface::position, float>) {
  using T = typename C::scalar;
  SmallScene<C::interface, T> s;
  const auto rest = [&](double seconds) {
    for (const Nanoseconds end = s.now + nanoseconds(seconds); s.now < end;)
      CHECK_FALSE(s.cycle({}).status.has(Reason::blocked));
  };
  rest(1);  // closes
  CHECK(s.finger == doctest::Approx(0.6).epsilon(1e-3));
  CHECK(s.arm.q()[0] == doctest::Approx(0.2).epsilon(1e-3));
  const double arm = s.arm.q()[1];
  // 4 N down on the finger tip, 0.1 m out: the finger yields by 0.4 N m / 0.4, the arm with its friction
  // alone
  double farthest = 0;
  for (int k = 0; k < 200; ++k) {
    s.cycle({T(0), T(-1), T(-0.1)});
    farthest = std::min(farthest, s.finger - 0.6);
  }
  CHECK(farthest == doctest::Approx(-0.1 / 0.4 * 2).epsilon(0.2));         // felt and given: twice the touch
  CHECK(s.arm.q()[1] - arm == doctest::Approx(-0.1 * 0.8).epsilon(0.25));  // 1 N m against 10 N m s
  rest(3);
  CHECK(s.finger == doctest::Approx(0.6).epsilon(1e-2));
  CHECK(std::abs(s.arm.dq()[1]) < 1e-3);
}

TEST_CASE(
    "Resolver in groups: starts where the robot is, holds it while it stops, and goes on without a step") {
  SmallScene<Interface::velocity, double> s;
  // At the start the finger is held against gravity, the arm stands.
  CHECK(s.memory.command().valid);
  CHECK(s.memory.command().velocity == JointVelocity<3>{});
  CHECK(s.memory.command().torque[2] == doctest::Approx(gravity_torque(SmallModel{}, s.measured.q)[2]));
  for (int k = 0; k < 100; ++k) s.cycle({20, 5, 0});
  CHECK(s.memory.group().v[0] > 0.2);
  const double asked = s.law_memory.seconds;
  s.robot.stop(s.memory);
  JointVelocity<3> last = s.memory.command().velocity;
  double stood = 0;
  for (int k = 0; k < 200; ++k) {
    const auto out = s.cycle({20, 5, 0});
    CHECK(out.status.has(Reason::stopping));
    for (std::size_t i = 0; i < 2; ++i)
      CHECK(std::abs(out.command.velocity[i] - last[i]) <= 40 * 0.004 * (1 + 1e-9));
    last = out.command.velocity;
    const double held = gravity_torque(SmallModel{}, s.measured.q)[2] - out.command.torque[2];
    const double mass = mass_matrix(SmallModel{}, s.measured.q)(2, 2);
    if (k < 22) {  // it brakes, for 15 times 6 ms
      CHECK(held * s.measured.dq[2] >= -1e-12);
      stood = s.measured.q[2];
    }
    const double most = mass * std::abs(s.measured.dq[2]) / 0.006 + 0.002 * std::abs(s.measured.dq[2]);
    const double spring = mass * (0.15 / 0.006) * (0.15 / 0.006) * std::abs(s.measured.q[2] - stood);
    CHECK(std::abs(held) <= most + spring + 1e-12);
    CHECK(out.fallback[2] == out.command.torque[2]);
    CHECK(out.fallback[0] == 0);
  }
  CHECK(s.memory.group().v == JointVelocity<2>{});
  CHECK(s.law_memory.seconds == asked);
  s.robot.resume(s.memory);
  for (int k = 0; k < 100; ++k) {
    const auto out = s.cycle({20, 5, 0});
    for (std::size_t i = 0; i < 2; ++i)
      CHECK(std::abs(out.command.velocity[i] - last[i]) <= 40 * 0.004 * (1 + 1e-9));
    last = out.command.velocity;
  }
  CHECK(s.memory.group().v[0] > 0.2);
  CHECK(s.law_memory.seconds == doctest::Approx(asked + 0.4));
}

TEST_CASE("Resolver in groups: bad news of a finger are no news of the arm either, and both are held") {
  SmallScene<Interface::velocity, double> s;
  for (int k = 0; k < 100; ++k) s.cycle({20, 5, 0});
  const State<3> good = s.measured;
  Status status;
  for (int k = 0; k < 100; ++k) {
    s.now += 4ms;
    s.measured = good;
    s.measured.time = s.now;
    s.measured.q[2] = std::numeric_limits<double>::quiet_NaN();
    const auto out = s.resolve({20, 5, 0});
    CHECK(out.status.has(Reason::state_not_finite));
    CHECK(s.memory.measured().q == good.q);
    for (std::size_t i = 0; i < 3; ++i) CHECK(std::isfinite(out.command.torque[i] + out.command.velocity[i]));
    status = out.status;
  }
  CHECK(status.has(Reason::state_stale));
  CHECK(s.memory.group().v == JointVelocity<2>{});
  CHECK(s.memory.command().torque[2] ==
        doctest::Approx(gravity_torque(SmallModel{}, good.q)[2]).epsilon(1e-12));
}

TEST_CASE("Resolver in groups: a torque that is not finite brakes the arm and holds the hand") {
  SmallScene<Interface::velocity, double> s;
  for (int k = 0; k < 100; ++k) s.cycle({20, 5, 0});
  s.law.broken = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 100; ++k) {
    const auto out = s.cycle({20, 5, 0});
    CHECK(out.status.has(Reason::torque_not_finite));
    CHECK(out.command.torque[2] == out.fallback[2]);
  }
  CHECK(s.memory.group().v == JointVelocity<2>{});
}

TEST_CASE("Resolver in groups: while the arm is blocked the hand goes on") {
  SmallScene<Interface::velocity, double> s;
  s.arm.hold_fast(0, true);
  bool blocked = false;
  for (int k = 0; k < 300; ++k) {
    const auto out = s.cycle({60, 0, 0});
    blocked |= out.status.has(Reason::blocked);
  }
  CHECK(blocked);
  CHECK(s.finger == doctest::Approx(0.6).epsilon(0.02));  // closed meanwhile
  s.arm.hold_fast(0, false);
  for (int k = 0; k < 300; ++k) s.cycle({});
  CHECK_FALSE(s.cycle({}).status.has(Reason::blocked));
}

TEST_CASE("Resolver in groups: what a guard made of one part does not disturb the other") {
  SmallScene<Interface::velocity, double> s;
  for (int k = 0; k < 50; ++k) s.cycle({20, 5, 0});
  const auto before = s.memory.group();
  auto command = s.memory.command();
  command.torque[2] = 0.01;
  s.robot.sent(s.memory, command);
  CHECK(s.memory.command().torque[2] == 0.01);
  CHECK(s.memory.group().v == before.v);
  CHECK(s.memory.group().last == before.last);
  command.velocity[0] = 0;
  s.robot.sent(s.memory, command);
  CHECK(s.memory.group().v[0] == 0);
}

TEST_CASE("Resolver in groups: refuses friction out of range") {
  HybridConfiguration<2, 1> c{
      .stiff = {.limits = limits<2, double>(150), .period = 4ms, .virtual_damping = 0},
      .limits = limits<1, double>(1)};
  const auto make = [&] { static_cast<void>(resolver_of(by_velocity_and_torque<0b100>(SmallModel{}, c))); };
  CHECK_NOTHROW(make());
  c.viscous[0] = -1;
  CHECK_THROWS_AS(make(), ConfigurationError);
}
