#include "skinctl/control/skin_cartesian_control.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/largest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
template <class T>
using Touch = LinkWrenches<Arm, 0b110100, T>;
template <class L, class T>
using KnownFor = Quantities<Arm, L::needs, T, Touch<T>>;
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};
template <class T>
Transform<Link<5>, Tool, T> tool() {
  return Transform<Link<5>, Tool>(exp_so3(Xyz<double>{0.2, -0.1, 0.3}), {0.01, 0.02, 0.15})
      .template cast<T>();
}
static_assert(Law<SkinCartesianControl<5>, KnownFor<SkinCartesianControl<5>, double>>);
static_assert(SkinCartesianControl<5>::role == LawRole::reactive);
}  // namespace

TEST_CASE_TEMPLATE("SkinCartesianControl: a push on the tool's link acts in the chosen directions alone", T,
                   SKINCTL_SCALARS) {
  Seeded rng(20);
  const State<6, T> x{0ns, home.cast<T>(), {}};
  for (int k = 0; k < 20; ++k) {
    Touch<T> touch;
    touch.template set<5>({{T(5 * rng()), T(5 * rng()), T(5 * rng())}, {T(rng()), T(rng()), T(rng())}});
    using Both = SkinCartesianControl<5, Tool, T>;
    using Translation = SkinCartesianControl<5, Tool, T, Yields::translation>;
    using Rotation_ = SkinCartesianControl<5, Tool, T, Yields::rotation>;
    const KnownFor<Both, T> known(model, x, T(0.002), touch);
    const auto all = Both(tool<T>()).torque(known);
    const auto skin = SkinJointControl{}.torque(known);
    const T scale = T(100000) * epsilon<T>() * largest(skin);
    CHECK(largest(all - skin) < scale);
    const auto a = Translation(tool<T>()).torque(known), b = Rotation_(tool<T>()).torque(known);
    CHECK(largest(a + b - all) < scale);
    // By hand: the force at the tool, and the moment about its origin.
    const auto F = touch.template wrench<5>();
    const auto X = known.template pose<5>();
    const auto J = known.template jacobian<5>(tool<T>());
    using Load = typename decltype(J)::Load;
    const Xyz<T> force = X.axes() * F.force;
    const Xyz<T> moment = X.axes() * Xyz<T>(F.moment - cross(tool<T>().origin(), F.force));
    CHECK(largest(a - transpose(J) * Load{force, {}}) < scale);
    CHECK(largest(b - transpose(J) * Load{{}, moment}) < scale);
  }
}

TEST_CASE("SkinCartesianControl: a damped null space takes energy out, and nothing from the chosen motion") {
  using Law_ = SkinCartesianControl<5, Tool, double, Yields::translation, DampedNullSpace>;
  static_assert(Law_::needs.mass && !SkinCartesianControl<5>::needs.mass);
  const Law_ law(tool<double>(), 8);
  Seeded rng(21);
  const Touch<double> none;
  for (int k = 0; k < 50; ++k) {
    State<6> x{0ns, home, rng.vector<JointVelocity<6>>(0.5)};
    const KnownFor<Law_, double> known(model, x, 0.002, none);
    CHECK(power(law.torque(known), x.dq) <= 20.0);
    // Pure translation of the tool is not braked.
    const auto J = known.jacobian<5>(tool<double>());
    const auto inverse = damped_inverse(J, SingularityDamping<double>());
    x.dq = inverse.solve(Twist<Tool, Base, Tool, Base>{{rng(), rng(), rng()}, {}});
    const KnownFor<Law_, double> moving(model, x, 0.002, none);
    CHECK(largest(law.torque(moving)) < 1e-9);
    // Pure rotation is, at the rate: M^-1 tau = -rate dq.
    x.dq = inverse.solve(Twist<Tool, Base, Tool, Base>{{}, {rng(), rng(), rng()}});
    const KnownFor<Law_, double> turning(model, x, 0.002, none);
    JointAcceleration<6> a;
    for (std::size_t i = 0; i < 6; ++i) a[i] = -8 * x.dq[i];
    CHECK(largest(law.torque(turning) - turning.mass() * a) < 1e-9);
  }
  CHECK_THROWS_AS(Law_(tool<double>(), 0.0), ConfigurationError);
}

TEST_CASE(
    "SkinCartesianControl: a push on the forearm moves the tool as it would, and stays bounded when "
    "stretched") {
  using Law_ = SkinCartesianControl<5, Tool, double, Yields::translation>;
  const Law_ law(tool<double>());
  Touch<double> touch;
  touch.set<2>({{0, 20, 5}, {0, 1, 3}});
  for (const double elbow : {1.4, 0.1, 1e-3, 0.0}) {
    State<6> x{0ns, home, {}};
    x.q[2] = elbow;
    const KnownFor<Law_, double> known(model, x, 0.002, touch);
    const auto tau = law.torque(known);
    const auto skin = SkinJointControl{}.torque(known);
    CAPTURE(elbow);
    CHECK(largest(tau) > 0.1);
    CHECK(largest(tau) < 12 * largest(skin));
  }
}
