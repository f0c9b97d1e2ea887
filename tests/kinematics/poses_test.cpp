#include "skinctl/kinematics/poses.hpp"

#include <doctest/doctest.h>

#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<Poses<ur5::Model, 0b111111>>);
static_assert(sizeof(Poses<ur5::Model, 0b100100>) == 2 * sizeof(Transform<Base, Link<2>>),
              "only what was asked for");

namespace {

template <std::size_t N, class F>
void for_each_index(F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f(std::integral_constant<std::size_t, I>{}), ...);
  }(std::make_index_sequence<N>{});
}

/// The largest difference between a pose and 12 numbers, the model's frame turned back to the table's.
template <class X>
double difference(const X& X_BL, double turn, const double* R, const double* p) {
  const double c = std::cos(turn), s = std::sin(turn);
  const auto x = c * X_BL.axis_x() - s * X_BL.axis_y();
  const auto y = s * X_BL.axis_x() + c * X_BL.axis_y();
  const auto z = X_BL.axis_z();
  const auto o = X_BL.origin();
  const double mine[12] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z, o.x, o.y, o.z};
  double worst = 0;
  for (std::size_t k = 0; k < 12; ++k) {
    const double e = std::abs(mine[k] - (k < 9 ? R[k] : p[k - 9]));
    if (!(e <= worst)) worst = e;
  }
  return worst;
}

}  // namespace

TEST_CASE("poses: KDL and MuJoCo agree at 1000 random states") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::KdlOracle kdl(robot.table);
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
      const Motion<N> at(random);
      const auto poses = link_poses(robot.model, at.q);
      for_each_index<N>([&](auto i) {
        double R[9], p[3];
        kdl.pose(int(i.value), at.q.data, R, p);
        worst = std::max(worst, difference(poses.template get<i.value>(), robot.turn[i.value], R, p));
        mujoco.pose(int(i.value), at.q.data, R, p);
        worst = std::max(worst, difference(poses.template get<i.value>(), robot.turn[i.value], R, p));
      });
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-12);
  });
}

TEST_CASE("poses: the UR5 at zero is stretched along -x, its flange where the maker's table puts it") {
  const auto poses = link_poses<link_bit<5>>(ur5::Model{}, JointPosition<6>{});
  const auto& d = ur5::Description::flange;
  const auto X_BF = poses.get<5>() * Transform<Link<5>, Flange>::translation_xyz(d[0], d[1], d[2]);
  CHECK(X_BF.origin().x == doctest::Approx(-0.425 - 0.39225));
  CHECK(X_BF.origin().y == doctest::Approx(-0.10915 - 0.0823));
  CHECK(X_BF.origin().z == doctest::Approx(0.089159 - 0.09465));
}

TEST_CASE("poses: asking for fewer gives the same numbers to the bit") {
  const auto robot = ur5_robot();
  oracle::Random random(2);
  for (int k = 0; k < 100; ++k) {
    const Motion<6> at(random);
    const JointAngles<ur5::Model, double> angles(robot.model, at.q);
    const Poses<ur5::Model, 0b111111> all(robot.model, angles);
    const Poses<ur5::Model, 0b001010> some(robot.model, angles);
    CHECK(all.get<1>() == some.get<1>());
    CHECK(all.get<3>() == some.get<3>());
  }
}

TEST_CASE_TEMPLATE("poses: axes stay orthonormal at extreme angles, and a NaN stays behind its joint", T,
                   float, double) {
  for (T x : {T(0), T(1e-8), T(1), T(3.14159265358979), T(1e6)}) {
    const auto poses = link_poses(ur5::Model{}, JointPosition<6, T>::constant(x));
    CAPTURE(x);
    CHECK(rotation_error(poses.template get<5>().axes()) <= T(32) * std::numeric_limits<T>::epsilon());
  }
  JointPosition<6, T> q;
  q[3] = std::numeric_limits<T>::quiet_NaN();
  const auto poses = link_poses(ur5::Model{}, q);
  CHECK(rotation_error(poses.template get<2>().axes()) <= tolerance<T>);
  CHECK(poses.template get<5>().axis_x().x != poses.template get<5>().axis_x().x);
}

// Links 1 to 3 of a UR5 turn about horizontal axes, and the model's type knows it.
static_assert(is_known<decltype(std::declval<Poses<ur5::Model, 0b111111>>().place<0>().z.z)>);
static_assert(is_zero<decltype(std::declval<Poses<ur5::Model, 0b111111>>().place<3>().z.z)>);
static_assert(!is_known<decltype(std::declval<Poses<ur5::Model, 0b111111>>().place<4>().z.z)>);

TEST_CASE("poses: what the type knows of a place is what is stored") {
  oracle::Random random(7);
  for (int k = 0; k < 20; ++k) {
    JointPosition<6> q;
    for (auto& x : q) x = random.uniform(-3, 3);
    const Poses<ur5::Model, 0b111111> poses(ur5::Model{}, q);
    detail::unrolled<6>([&](auto i) {
      const auto place = poses.place<i>();
      const auto X = poses.get<i>();
      CHECK(dense<double>(place.x) == X.axis_x());
      CHECK(dense<double>(place.y) == X.axis_y());
      CHECK(dense<double>(place.z) == X.axis_z());
      CHECK(dense<double>(place.p) == X.origin());
    });
  }
}
