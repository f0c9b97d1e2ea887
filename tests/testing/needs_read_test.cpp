// What the shipped laws ask for, they read; a law that asks for more is found.
//
// Promise: a law asks for no quantity of the model that it does not read
// Tried: 13 shipped laws; a law that asks for M and a Jacobian in vain is named

#include "skinctl/testing/needs_read.hpp"

#include <doctest/doctest.h>

#include "skinctl/skinctl.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const ur5::Model arm;
const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0.02, 0, 0.15);

template <class L>
std::string unread_by(const L& law) {
  const Needs read = [&] {
    if constexpr (requires { typename L::Goal; }) {
      return needs_read(arm, law, 3, 20, typename L::Goal{});
    } else {
      return needs_read(arm, law, 3, 20);
    }
  }();
  return in_words(unread(L::needs, read));
}

/// Asks for M, the pose of link 2 and the Jacobian of link 6, and reads the angles.
struct Greedy : StatelessLaw<Greedy> {
  static constexpr Needs needs = {
      .poses = link_bit<1>, .jacobians = link_bit<5>, .angles = true, .mass = true};
  JointTorque<6> torque(const auto& known) const noexcept {
    return JointTorque<6>::constant(known.angles().sin[0]);
  }
};
/// The same, but it reads them, M only where it is fast.
struct Modest : StatelessLaw<Modest> {
  static constexpr Needs needs = Greedy::needs;
  JointTorque<6> torque(const auto& known) const noexcept {
    const auto f = known.template jacobian<5>() * known.dq();
    const double height = known.template pose<1>().origin().z;
    return JointTorque<6>::constant(f.linear.x + height + (known.dq()[0] > 0.1 ? known.mass()(0, 0) : 0));
  }
};

}  // namespace

TEST_CASE("needs: what a law asks for and does not read is named") {
  CHECK(unread_by(Greedy{}) == "poses of 2, Jacobians of 6, M");
  CHECK(unread_by(Modest{}) == "-");
}

TEST_CASE("needs: no shipped law asks for what it does not read") {
  CHECK(unread_by(GravityControl{}) == "-");
  CHECK(unread_by(SkinJointControl{}) == "-");
  CHECK(unread_by(FrictionControl<6>(JointFriction<6>(JointFriction<6>::Settings{}))) == "-");
  CHECK(unread_by(JointLimitLaw<6>()) == "-");
  CHECK(unread_by(SplineJoint<6>()) == "-");
  CHECK(unread_by(JointControl<6>()) == "-");
  CHECK(unread_by(JointImpedance<6>()) == "-");
  CHECK(unread_by(CartesianImpedance<6, 5>(OperationalSpace<6, 5>(X_LT), {})) == "-");
  CHECK(unread_by(SplineOperational<6, 5>(X_LT, OperationalSettings<6>{})) == "-");
  CHECK(unread_by(OperationalControl<6, 5>(X_LT, OperationalSettings<6>{})) == "-");
  CHECK(unread_by(ForceControl<6, 5>(X_LT)) == "-");
  CHECK(unread_by(SkinCartesianControl<5>(X_LT)) == "-");
  CHECK(unread_by(NullSpacePosture<6, 5>(X_LT, JointPosition<6>{}, 4.0)) == "-");
}
