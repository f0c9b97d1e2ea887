#include "skinctl/kinematics/joint_frame.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("joint frame: to the link undoes to the parent, whatever the joint") {
  const auto robot = random_robot<MixedTree>("mixed tree", 3);
  using M = decltype(robot)::Model;
  oracle::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Motion<9> at(random);
    const JointAngles<M, double> angles(robot.model, at.q);
    const Xyz<double> v{at.dq[0], at.dq[1], at.dq[2]};
    const auto check = [&](const auto& frame) {
      const auto back = frame.to_link(frame.to_parent(v));
      CHECK(back.x == doctest::Approx(v.x));
      CHECK(back.y == doctest::Approx(v.y));
      CHECK(back.z == doctest::Approx(v.z));
    };
    check(joint_frame<0>(robot.model, angles));
    check(joint_frame<3>(robot.model, angles));
    check(joint_frame<4>(robot.model, angles));
    // A sliding joint moves its origin along its axis by what q changes.
    auto further = at.q;
    further[1] += 0.25;
    const JointAngles<M, double> moved(robot.model, further);
    const auto d = joint_frame<1>(robot.model, moved).p - joint_frame<1>(robot.model, angles).p;
    CHECK(dot(d, d) == doctest::Approx(0.0625));
    CHECK(dot(d, joint_frame<1>(robot.model, angles).to_parent(UnitZ{})) == doctest::Approx(0.25));
  }
}

TEST_CASE("joint angles: only those on the way to the asked links, offsets included") {
  using M = ur5::Model;
  static_assert(JointAngles<M, double, link_bit<2>>::count == 3);
  static_assert(JointAngles<M, double, 0>::count == 0);
  auto links = ur5::Calibrated<>::Links{};
  for (std::size_t i = 0; i < 6; ++i) links[i] = ur5::Description::links[i];
  links[2][LinkParameter::offset] = 0.5;
  const ur5::Calibrated<> turned(links);
  const JointPosition<6> q{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  const JointAngles<ur5::Calibrated<>, double> angles(turned, q);
  CHECK(angles.sin[2] == doctest::Approx(std::sin(0.8)).epsilon(1e-15));
  CHECK(angles.cos[3] == doctest::Approx(std::cos(0.4)).epsilon(1e-15));
}

TEST_CASE("typed constants: a UR5's zeros and ones leave no arithmetic") {
  const ur5::Model model;
  const JointAngles<ur5::Model, double> angles(model, JointPosition<6>{});
  static_assert(is_zero<decltype(joint_frame<1>(model, angles).p.x)>);
  static_assert(is_zero<decltype(joint_frame<2>(model, angles).alpha.sin)>);
  static_assert(std::is_same_v<decltype(joint_frame<4>(model, angles).alpha.sin), TypedConstant<1>>);
  CHECK(joint_frame<1>(model, angles).p.z == ur5::Description::d1);
}
