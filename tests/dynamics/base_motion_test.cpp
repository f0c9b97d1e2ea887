// Promise: the dynamics of a robot on a base that moves are those of a robot with the base's joints in front
// Tried: six joints before a UR5, a hand and a tree, 300 motions: KDL and MuJoCo agree to 1e-12

#include "skinctl/dynamics/base_motion.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/model/mounted.hpp"
#include "skinctl/model/moving_base.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/sliding_robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Three slides along the axes of the world, then turns about z, x and y of what is turned already.
struct Carrier {
  oracle::Robot table;

  explicit Carrier(const std::array<double, 3>& gravity) {
    table.gravity = gravity;
    for (int k = 0; k < 6; ++k) {
      oracle::Body b;
      b.parent = k - 1;
      b.motion = k < 3 ? oracle::Motion::prismatic : oracle::Motion::revolute;
      if (k != 3) b.R = {0, 0, 1, 1, 0, 0, 0, 1, 0};  // `next_axis`
      b.mass = 1, b.inertia = {0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1};
      table.bodies.push_back(b);
    }
  }
  /// The motion of the last body, by adding up angular velocities and accelerations along the chain.
  [[nodiscard]] static BaseMotion<double> motion(const double* q, const double* dq, const double* ddq,
                                                 const Xyz<double>& gravity_W, Rotation<double>& R_WB) {
    BaseMotion<double> out;
    R_WB = {};
    for (int k = 3; k < 6; ++k) {
      const double c = std::cos(q[k]), s = std::sin(q[k]);
      const Rotation<double> turn{{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
      const Rotation<double> R = k == 3 ? turn : next_axis * turn;
      const Xyz<double> carried = R.transpose() * out.angular, z{0, 0, 1};
      out.turning = R.transpose() * out.turning + ddq[k] * z + dq[k] * cross(carried, z);
      out.angular = carried + dq[k] * z;
      R_WB = R_WB * R;
    }
    out.linear = R_WB.transpose() * Xyz<double>(Xyz<double>{ddq[0], ddq[1], ddq[2]} - gravity_W);
    return out;
  }
};

template <std::size_t N>
struct Carried {
  double q[N + 6], dq[N + 6], ddq[N + 6];
  BaseMotion<double> base;
  Rotation<double> R_WB;
  JointPosition<N> arm_q;
  JointVelocity<N> arm_dq;
  JointAcceleration<N> arm_ddq;

  Carried(oracle::Random& random, const Xyz<double>& gravity) {
    for (std::size_t i = 0; i < N + 6; ++i) {
      q[i] = random.uniform(-3, 3), dq[i] = random.uniform(-2, 2), ddq[i] = random.uniform(-3, 3);
      if (i < 6) continue;
      arm_q[i - 6] = q[i], arm_dq[i - 6] = dq[i], arm_ddq[i - 6] = ddq[i];
    }
    base = Carrier::motion(q, dq, ddq, gravity, R_WB);
  }
};

template <class F>
void for_some_robots(F&& f) {
  f(ur5_robot());
  f(allegro_robot());
  f(random_robot<MixedTree>("mixed tree", 11));
}

}  // namespace

TEST_CASE("inverse dynamics on a moving base: KDL and MuJoCo with six joints in front of the robot") {
  for_some_robots([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    CAPTURE(robot.name);
    const auto table = oracle::joined(Carrier(robot.table.gravity).table, 5, robot.table,
                                      {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0});
    oracle::KdlOracle kdl(table);
    oracle::MujocoOracle mujoco(table);
    oracle::Random random(3);
    const auto& g = robot.table.gravity;
    double worst = 0, exact = 0, moved = 0;
    for (int k = 0; k < 100; ++k) {
      const Carried<N> at(random, {g[0], g[1], g[2]});
      using M = std::remove_cvref_t<decltype(robot.model)>;
      const JointAngles<M, double> angles(robot.model, at.arm_q);
      const auto tau = inverse_dynamics_on(robot.model, angles, at.arm_dq, at.arm_ddq, at.base);
      double expected[N + 6];
      kdl.inverse_dynamics(at.q, at.dq, at.ddq, expected);
      worst = std::max(worst, relative_error(tau, expected + 6, N));
      mujoco.inverse_dynamics(at.q, at.dq, at.ddq, expected);
      worst = std::max(worst, relative_error(tau, expected + 6, N));
      // What the base adds is the difference to a base at rest, and mass times acceleration does not change.
      const auto still = inverse_dynamics(robot.model, at.arm_q, at.arm_dq, at.arm_ddq);
      const auto adds = base_torque(robot.model, at.arm_q, at.arm_dq, at.base);
      for (std::size_t i = 0; i < N; ++i) {
        exact = std::max(exact, std::abs(tau[i] - still[i] - adds[i]));
        moved = std::max(moved, std::abs(adds[i]));
      }
    }
    CHECK(worst <= 1e-12);
    CHECK(exact <= 1e-11 * moved);
  });
}

TEST_CASE_TEMPLATE("base_torque: nothing of a base at rest, and that of another gravity on a slope", T,
                   SKINCTL_SCALARS) {
  using Arm = ur5::Calibrated<T>;
  const Arm arm = calibrated_from<ur5::Description, T>();
  const T digits = T(64) * std::numeric_limits<T>::epsilon();
  const JointPosition<6, T> q{T(0.3), T(-1.2), T(1.4), T(-0.8), T(-1.57), T(0.4)};
  const auto dq = JointVelocity<6, T>::constant(T(0.7));
  const Xyz<T> up{T(0), T(0), T(9.81)};
  const auto none = base_torque(arm, q, dq, BaseMotion<T>{.linear = up});
  for (const T& tau : none) CHECK(std::abs(tau) <= digits * T(60));
  // A slope of 0.3 rad is a mounting of 0.3 rad.
  const T c = std::cos(T(0.3)), s = std::sin(T(0.3));
  const Mounted<Arm, T> mounted(arm, {{double(c), 0, -double(s)}, {0, 1, 0}, {double(s), 0, double(c)}});
  const auto slope = base_torque(arm, q, dq, BaseMotion<T>{.linear = {T(-9.81) * s, T(0), T(9.81) * c}});
  const auto expected = gravity_torque(mounted, q) - gravity_torque(arm, q);
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(slope[i] - expected[i]) <= digits * T(100));
}

TEST_CASE("acceleration_at: of a point that turns with its base") {
  const BaseMotion<double> base{{0, 0, 2}, {0, 0, 0.5}, {0.1, 0, 9.81}};
  const auto a = acceleration_at(base, Xyz<double>{0.3, 0, 0});
  CHECK(a.x == doctest::Approx(0.1 - 4 * 0.3));  // towards the axis
  CHECK(a.y == doctest::Approx(0.5 * 0.3));
  CHECK(a.z == doctest::Approx(9.81));
}

TEST_CASE("OnMovingBase: the same robot, checked; others know that it moves") {
  const OnMovingBase<ur5::Model> arm{ur5::Model{}};
  using Arm = std::remove_const_t<decltype(arm)>;
  static_assert(base_moves<Arm> && base_moves<Weightless<Arm>> && !base_moves<ur5::Model>);
  static_assert(base_moves<OnMovingBase<Loaded<ur5::Model, 5>>>);
  static_assert(is_zero<decltype(arm.number<1, LinkParameter::cos_alpha, double>())>);  // static as before
  const JointPosition<6> q{0.3, -1.2, 1.4, -0.8, -1.57, 0.4};
  CHECK(gravity_torque(arm, q) == gravity_torque(ur5::Model{}, q));
  const auto refuses = [](const MovingBaseSettings& s) {
    CHECK_THROWS_AS(static_cast<void>(OnMovingBase(ur5::Model{}, s)), ConfigurationError);
  };
  refuses({.max_rate = 0});
  refuses({.max_acceleration = std::nan("")});
  refuses({.max_turning = 1e5});
  refuses({.max_age = 20s});
  refuses({.max_age = 10ms, .fade = 20ms});
  refuses({.max_ahead = -1ns});
}
