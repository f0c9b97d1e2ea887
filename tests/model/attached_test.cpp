#include <doctest/doctest.h>

#include "skinctl/skinctl.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/worst_torque.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Slides and turns on its base: the placement of both kinds of first links is computed anew.
struct Twig {
  static constexpr std::size_t joints = 3;
  static constexpr std::array<int, 3> parents = {-1, 0, -1};
  static constexpr std::array<JointKind, 3> kinds = {JointKind::prismatic, JointKind::revolute,
                                                     JointKind::revolute};
};
Rotation<double> axes_of(const oracle::Body& b) {
  return placed(b).R;
}
}  // namespace

TEST_CASE("attached: any tree on any link of another, static parts stay static, frames stay") {
  const auto twig = random_robot<Twig>("twig", 21);
  oracle::Random random(22);
  const oracle::Body stand = oracle::random_body(random, -1, oracle::Motion::revolute);
  const auto both =
      attach<2>(ur5::Model{}, twig.model, Stand{axes_of(stand), {stand.p[0], stand.p[1], stand.p[2]}});
  using Both = std::remove_cvref_t<decltype(both)>;
  static_assert(RobotModel<Both> && Both::joints == 9 && Both::parents[6] == 2 && Both::parents[7] == 6);
  static_assert(is_zero<decltype(both.number<1, LinkParameter::cos_alpha, double>())>);
  static_assert(is_zero<decltype(both.number<7, LinkParameter::sin_gamma, double>())>);
  CHECK(worst_torque(both, oracle::joined(oracle::ur5(), 2, twig.table, stand.R, stand.p), 200, 4) <= 1e-12);

  const auto q = JointPosition<9>::constant(0.7);
  const auto poses = link_poses(both, q);
  const auto arm = link_poses(ur5::Model{}, JointPosition<6>::constant(0.7));
  const auto alone = link_poses(twig.model, JointPosition<3>::constant(0.7));
  CHECK(poses.get<5>() == arm.get<5>());
  const auto at =
      arm.get<2>() * Transform<Link<2>, Base>(axes_of(stand), {stand.p[0], stand.p[1], stand.p[2]});
  const auto expected = at * alone.get<1>();
  CHECK(dot(expected.axis_x(), poses.get<7>().axis_x()) == doctest::Approx(1).epsilon(1e-14));
  CHECK(dot(expected.axis_y(), poses.get<7>().axis_y()) == doctest::Approx(1).epsilon(1e-14));
  CHECK(expected.origin().x == doctest::Approx(poses.get<7>().origin().x).epsilon(1e-13));
}

TEST_CASE("attached: a stand that is no rotation is refused") {
  Stand bent;
  bent.R.x.y = 0.01;
  CHECK_THROWS_AS(static_cast<void>(attach<-1>(BareBase{}, ur5::Model{}, bent)), ConfigurationError);
}

TEST_CASE("mounted: gravity follows the base, on a wall, a ceiling and at any tilt") {
  oracle::Random random(5);
  const Rotation<double> wall{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, ceiling{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const auto r = random.rotation();
  const Rotation<double> tilted{{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
  Mounted<ur5::Model> arm(ur5::Model{}, ceiling);
  static_assert(is_zero<decltype(arm.number<1, LinkParameter::cos_alpha, double>())>);
  CHECK(arm.gravity<double>() == Xyz<double>{0, 0, 9.81});
  const double up[3] = {0.4, 0.5, std::sqrt(1 - 0.41)};
  for (const auto& R : {wall, ceiling, tilted}) {
    arm.mount(R);
    auto table = oracle::ur5();
    // The world's down in the axes of the base, from the rows of the rotation.
    table.gravity = {-9.81 * R.x.z, -9.81 * R.y.z, -9.81 * R.z.z};
    CHECK(worst_torque(arm, table, 200, 4) <= 1e-12);
    // Potential energy is the world's height: m g times the z of every centre of mass, seen from the world.
    const Xyz<double> g = arm.gravity<double>();
    const Xyz<double> v{up[0], up[1], up[2]};
    CHECK(-dot(g, v) / 9.81 == doctest::Approx((R * v).z).epsilon(1e-14));
  }
  Rotation<double> bent;
  bent.x.y = 0.1;
  CHECK_THROWS_AS(arm.mount(bent), ConfigurationError);
  CHECK_THROWS_AS(Mounted<ur5::Model>(ur5::Model{}, bent), ConfigurationError);
}

TEST_CASE("loaded: a payload on the flange, exchanged at run time, costs only its own link") {
  const LinkInertia gripper{1.3, {0.01, -0.02, 0.05}, 2e-3, 3e-3, 1.5e-3, 1e-4, -2e-4, 3e-4};
  oracle::Random random(6);
  const auto r = random.rotation();
  const Rotation<double> R{{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
  const Xyz<double> p{0.02, 0.03, 0.0823};
  Loaded<ur5::Model, 5> arm(ur5::Model{}, seen_from(R, p, gripper));
  static_assert(is_zero<decltype(arm.number<4, LinkParameter::c_x, double>())>);
  static_assert(is_zero<decltype(arm.number<5, LinkParameter::cos_alpha, double>())>);
  static_assert(std::is_same_v<decltype(arm.number<5, LinkParameter::c_x, double>()), double>);

  oracle::Robot table = oracle::ur5();
  oracle::Body tool;
  tool.parent = 5, tool.motion = oracle::Motion::fixed;
  tool.R = r, tool.p = {p.x, p.y, p.z}, tool.mass = gripper.mass;
  tool.com = {gripper.c[0], gripper.c[1], gripper.c[2]};
  tool.inertia = {gripper.xx, gripper.xy, gripper.xz, gripper.xy, gripper.yy,
                  gripper.yz, gripper.xz, gripper.yz, gripper.zz};
  table.bodies.push_back(tool);
  CHECK(worst_torque(arm, oracle::without_fixed(table), 200, 4) <= 1e-12);

  arm.carry({});
  CHECK(worst_torque(arm, oracle::ur5(), 200, 4) <= 1e-12);
  CHECK_THROWS_AS(arm.carry(LinkInertia{-1}), ConfigurationError);
  CHECK_THROWS_AS(arm.carry(LinkInertia{1, {0, 0, 0}, 1, 1, 3}), ConfigurationError);
  CHECK(worst_torque(arm, oracle::ur5(), 200, 4) <= 1e-12);
}
