// runs long: mixtures of groups against small steps
// Joints of several interfaces against the equations of motion of the whole robot.
//
// Promise: joints by position, velocity and torque, in any mixture and order, move as the equations of
// motion of the whole robot say; an arm takes the recoil of its finger, and the finger feels the arm
// Tried: three joints in six mixtures, pushed at arm and finger, every integrator: within 2 % of the way,
// 1 mrad and 2 ms (by position 5 ms); the recoil is 11.7 mrad

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "tests/support/arm_with_finger.hpp"
#include "tests/support/grouped_plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Model3 = ArmWithFingerModel;
constexpr double friction = 2;  // of the joints by position and velocity [N m s/rad]

// The torques of hands and springs: `push` to the joints, and a spring that closes the finger.
struct Act {
  JointTorque<3> push;
  double stiffness = 0, damping = 0, goal = 0;

  JointTorque<3> operator()(const JointPosition<3>& q, const JointVelocity<3>& dq) const {
    JointTorque<3> tau = push;
    tau[2] += stiffness * (goal - q[2]) - damping * dq[2];
    return tau;
  }
};

// What acts on the joints of `on`, and gravity compensation.
template <LinkMask On>
struct Moved {
  struct Memory {};
  static constexpr Needs needs{.gravity = true};
  static constexpr LawRole role = LawRole::reactive;
  const Act* act;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<3> torque(const Memory&, const K& known) const noexcept {
    JointTorque<3> tau = (*act)(known.q(), known.dq());
    for (std::size_t i = 0; i < 3; ++i)
      if (((On >> i) & 1u) == 0) tau[i] = 0;
    return tau + known.gravity();
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

template <std::size_t N>
RobotConfiguration<N> configuration(bool stiff, bool by_position = false) {
  RobotConfiguration<N> c{.limits = JointLimits<N>({.lower = JointPosition<N>::constant(-3),
                                                    .upper = JointPosition<N>::constant(3),
                                                    .velocity = JointVelocity<N>::constant(100),
                                                    .acceleration = JointAcceleration<N>::constant(1e4),
                                                    .torque = JointTorque<N>::constant(1e3)}),
                          .period = 1ms,
                          .virtual_damping = 0,
                          .substep = 1ms};
  if (stiff && by_position) c.lag = 3ms;
  if (stiff) c.viscous_friction = JointTorque<N>::constant(friction);
  return c;
}
template <LinkMask V, LinkMask D, class... Parts>
auto robot(const Parts&... parts) {
  constexpr LinkMask P = 0b111u & ~(V | D);
  const auto with = [&](const auto&... groups) {
    return resolver_of(by_groups(Model3{}, groups..., parts...));
  };
  const auto p = [&](const auto&... groups) {
    if constexpr (P != 0) {
      return with(position_joints<P>(configuration<std::popcount(P)>(true, true)), groups...);
    } else {
      return with(groups...);
    }
  };
  const auto v = [&](const auto&... groups) {
    if constexpr (V != 0) {
      return p(velocity_joints<V>(configuration<std::popcount(V)>(true)), groups...);
    } else {
      return p(groups...);
    }
  };
  if constexpr (D != 0) {
    return v(torque_joints<D>(configuration<std::popcount(D)>(false)));
  } else {
    return v();
  }
}

const JointPosition<3> begin{0.2, 0.3, 0.5};

// The whole robot by its equations of motion: friction of the joints not in `free`, gravity compensated.
template <class Drive>
State<3> truth(LinkMask free, double until, const Drive& drive) {
  JointPosition<3> q = begin;
  JointVelocity<3> dq;
  const double h = 5e-5;
  Act act;
  for (double t = 0; t < until - 0.5 * h; t += h) {
    drive(t, act);
    JointTorque<3> net = act(q, dq) - coriolis_torque(Model3{}, JointAngles<Model3, double>({}, q), dq);
    for (std::size_t i = 0; i < 3; ++i)
      if (((free >> i) & 1u) == 0) net[i] -= friction * dq[i];
    JointAcceleration<3> ddq;
    math::Ldlt<3, double>(mass_matrix(Model3{}, q).data).solve(net.data, ddq.data);
    dq = integrate(dq, ddq, h);
    q = integrate(q, dq, h);
  }
  return {0ns, q, dq};
}
// The same by a resolver whose joints of `V` take velocities, of `D` torques and the others positions.
template <LinkMask V, LinkMask D, class Drive, class... Parts>
JointPosition<3> resolved(double until, const Drive& drive, const Parts&... parts) {
  const auto resolver = robot<V, D>(parts...);
  GroupedPlant<Model3, D, V> plant(Model3{}, begin, 0.003);
  Act act, pushed;
  // The finger's spring is a law; a push on a joint by torque is the world's.
  const Moved<0b111> law{&act};
  typename Moved<0b111>::Memory law_memory;
  auto memory = resolver.start({0ns, begin, {}});
  const NoTouch none[max_substeps];
  for (Nanoseconds now = 1ms; seconds<double>(now) <= until; now += 1ms) {
    drive(seconds<double>(now) - 5e-4, act);
    pushed.push = {};
    for (std::size_t i = 0; i < 3; ++i)
      if ((D >> i) & 1u) std::swap(pushed.push[i], act.push[i]);
    plant.command(memory.command());
    plant.run(1e-3, 10, [&](const auto& q, const auto& dq) { return pushed(q, dq); });
    const auto out = resolver.step(memory, law, law_memory, State<3>{now, plant.q(), plant.dq()},
                                   resolver.interval(memory, now), std::span<const NoTouch>(none));
    CHECK_FALSE(out.status.has(Reason::blocked));
    CHECK_FALSE(out.status.has(Reason::displaced));
  }
  return plant.q();
}

void close_finger(double t, Act& act) {
  act = {{}, 4, 0.03, 0.5};
  if (t > 0.1) act.goal = 1.5;
}
void push_arm(double t, Act& act) {
  act = {{}, 0, 0, 0};
  if (t > 0.05 && t < 0.25) act.push = {6, 4, 0};
}
void push_finger(double t, Act& act) {
  act = {{}, 4, 0.03, 0.5};
  if (t > 0.05 && t < 0.25) act.push = {0, 0, -1};
}

/// Compares with what the equations of motion say, but for the time that commands take: 2 ms by velocity, 5
/// ms by position.
template <LinkMask V, LinkMask D, class Drive, class... Parts>
State<3> compare(double until, const Drive& drive, double most, const Parts&... parts) {
  const State<3> want = truth(D, until, drive);
  const JointPosition<3> is = resolved<V, D>(until, drive, parts...);
  CAPTURE(V);
  CAPTURE(D);
  CAPTURE(until);
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    CAPTURE(want.q[i]);
    CAPTURE(want.dq[i]);
    CAPTURE(is[i]);
    const double late = (V | D) == 0b111 ? 0.002 : 0.005;
    CHECK(std::abs(is[i] - want.q[i]) <
          most * std::abs(want.q[i] - begin[i]) + late * std::abs(want.dq[i]) + 1e-3);
  }
  return want;
}

}  // namespace

TEST_CASE("Resolver in groups: the arm takes the recoil of a finger that closes") {
  double recoil = 0;
  for (double until : {0.15, 0.2, 0.3, 0.6}) {
    const auto want = compare<0b011, 0b100>(until, close_finger, 0.02);
    compare<0b000, 0b100>(until, close_finger, 0.02);
    recoil = std::max(recoil, std::abs(want.q[1] - begin[1]));
  }
  CHECK(recoil > 5e-3);
}

TEST_CASE("Resolver in groups: a finger that hangs loose is felt by the arm that swings it, and feels it") {
  for (double until : {0.15, 0.3, 0.6}) compare<0b011, 0b100>(until, push_arm, 0.02);
}

TEST_CASE("Resolver in groups: joints of any mixture, in any order, move as the robot's equations say") {
  for (const auto drive : {&push_arm, &push_finger})
    for (double until : {0.2, 0.5}) {
      compare<0b001, 0b100>(until, *drive, 0.02);  // V P T
      compare<0b100, 0b010>(until, *drive, 0.02);  // P T V
      compare<0b010, 0b101>(until, *drive, 0.02);  // T V T
      compare<0b101, 0b000>(until, *drive, 0.02);  // V P V
    }
}

TEST_CASE("Resolver in groups: with semi-implicit Euler too") {
  for (double until : {0.15, 0.3, 0.6}) {
    compare<0b011, 0b100>(until, push_arm, 0.02, SemiImplicitEuler{});
    compare<0b011, 0b100>(until, close_finger, 0.02, SemiImplicitEuler{});
  }
}

TEST_CASE_TEMPLATE(
    "Resolver in groups: the end of an arm feels like the mass of its tool shape, with the finger on it",
    Integrator, CrankNicolson, SemiImplicitEuler) {
  using Shape = ToolShape<1, 3>;
  // The arm's two joints move a point of its link in two directions; a push in these.
  const Shape shape({.X_LT = {{}, {0.4, 0, 0}}, .mass = Shape::diagonal({5, 5, 5}), .damping = {}});
  RobotConfiguration<2> arm = configuration<2>(false);
  const auto resolver =
      resolver_of(by_groups(Model3{}, velocity_joints<0b011>(arm),
                            torque_joints<0b100>(configuration<1>(false)), shape, Integrator{}));
  auto memory = resolver.start({0ns, begin, {}});
  const auto poses = Poses<Model3, all_links(3), double>(Model3{}, begin);
  const auto J = jacobian<1>(poses, Transform<Link<1>, Tool>{{}, {0.4, 0, 0}});
  double column[3][3] = {};
  J.for_each([&](auto i, const auto& c) {
    column[i.value][0] = c.linear.x, column[i.value][1] = c.linear.y, column[i.value][2] = c.linear.z;
  });
  // A force along the motion of joint 0, and one along that of joint 1: across each other.
  for (const std::size_t along : {0u, 1u}) {
    double length = 0;
    for (double x : column[along]) length += x * x;
    length = std::sqrt(length);
    Act act;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < 3; ++k) act.push[i] += 10 * column[along][k] / length * column[i][k];
    const Moved<0b011> law{&act};
    typename Moved<0b011>::Memory law_memory;
    auto m = memory;
    const NoTouch none[max_substeps];
    static_cast<void>(resolver.step(m, law, law_memory, State<3>{1ms, begin, {}}, resolver.interval(m, 1ms),
                                    std::span<const NoTouch>(none)));
    const auto dq = resolver.state(m).dq;
    double speed = 0, aside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double v = column[0][k] * dq[0] + column[1][k] * dq[1], e = column[along][k] / length;
      speed += v * e;
      aside += v * column[1 - along][k];
    }
    CHECK(speed == doctest::Approx(10.0 / 5 * 1e-3).epsilon(0.02));
    CHECK(std::abs(aside) < 1e-6);
  }
}
