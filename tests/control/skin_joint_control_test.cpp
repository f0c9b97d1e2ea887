#include "skinctl/control/skin_joint_control.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class T>
using Touch = LinkWrenches<ur5::Model, 0b010110, T>;
template <class T, class Skin = Touch<T>>
using KnownTo = Quantities<ur5::Model, SkinJointControl::needs, T, Skin>;
static_assert(Law<SkinJointControl, KnownTo<double>>);
static_assert(Law<SkinJointControl, KnownTo<float, NoTouch>>);
static_assert(SkinJointControl::role == LawRole::reactive && SkinJointControl::needs.touch);
}  // namespace

TEST_CASE_TEMPLATE("SkinJointControl: does the work of the wrenches on the links", T, float, double,
                   Digits50) {
  const ur5::Model model;
  Seeded rng(60);
  for (int k = 0; k < 20; ++k) {
    const State<6, T> state{0ns, rng.vector<JointPosition<6, T>>(3), {}};
    Touch<T> touch;
    for (auto& wrench : touch.data)
      for (T& x : wrench) x = T(20 * rng());
    const KnownTo<T> known(model, state, T(0.002), touch);
    const auto tau = SkinJointControl{}.torque(known);
    // Their power, by the velocities of the links, for a random velocity of the joints.
    const auto dq = rng.vector<JointVelocity<6, T>>(1);
    const Poses<ur5::Model, 0b111111, T> poses(model, known.angles());
    T expected(0);
    const auto add = [&](auto link) {
      constexpr std::size_t I = decltype(link)::value;
      const auto V = jacobian<I>(poses) * dq;
      const auto R_BL = poses.template get<I>().axes();
      const auto F_L = touch.template wrench<I>();
      expected += dot(R_BL * F_L.force, V.linear) + dot(R_BL * F_L.moment, V.angular);
    };
    add(std::integral_constant<std::size_t, 1>{});
    add(std::integral_constant<std::size_t, 2>{});
    add(std::integral_constant<std::size_t, 4>{});
    CHECK(magnitude(T(power(tau, dq) - expected)) <= T(400) * epsilon<T>() * T(20));
  }
}

TEST_CASE("SkinJointControl: a scene without skin feels nothing") {
  const ur5::Model model;
  const State<6> state{0ns, JointPosition<6>{0.1, -1.0, 1.0, 0.2, 0.3, 0.4}, {}};
  const NoTouch none;
  CHECK(SkinJointControl{}.torque(KnownTo<double, NoTouch>(model, state, 0.002, none)) == JointTorque<6>{});
}
