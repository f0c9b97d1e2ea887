#include "skinctl/dynamics/operational_inertia.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include "skinctl/kinematics/damped_inverse.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
struct Slider {
  static constexpr std::size_t joints = 1;
  static constexpr std::array<int, 1> parents = {-1};
  static constexpr auto kinds = all_of_kind<1>(JointKind::prismatic);
};
template <class T>
auto flange_jacobian(const JointPosition<6, T>& q) {
  return jacobian<5>(link_poses(ur5::Model{}, q),
                     Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6)));
}
template <class T>
auto mass_factors(const JointPosition<6, T>& q) {
  return MassFactors<ur5::Model, T>(mass_matrix(ur5::Model{}, q));
}
template <class T>
using Load = Wrench<Flange, Flange, Base, T>;
template <class T>
using Rise = Acceleration<Flange, Base, Flange, Base, T>;
}  // namespace

TEST_CASE_TEMPLATE("OperationalMobility: J M^-1 J', and the inertia undoes it", T, float, double) {
  const double eps = static_cast<double>(std::numeric_limits<T>::epsilon());
  oracle::Random random(1);
  double worst = 0, worst_inverse = 0;
  for (int k = 0; k < 100; ++k) {
    const Motion<6, T> at(random);
    const auto J = flange_jacobian(at.q);
    const auto A = operational_mobility(J, mass_factors(at.q));
    // The oracle: Eigen, in long double, from the same J and M.
    using Matrix = Eigen::Matrix<long double, 6, 6>;
    const auto M = mass_matrix(ur5::Model{}, at.q);
    const Matrix dense_J = as_eigen(J).template cast<long double>();
    const Matrix dense_M = Eigen::Map<const Eigen::Matrix<T, 6, 6>>(M.data).template cast<long double>();
    const Matrix expected = dense_J * dense_M.partialPivLu().solve(dense_J.transpose());
    T rows[36];
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 6; ++s) {
        rows[r * 6 + s] = A(r, s);
        CHECK(A(r, s) == A(s, r));
      }
    worst = std::max(worst, relative_error(rows, expected.data(), 36));

    const SingularityDamping<T> damping;
    const auto near = damped_inverse(J, damping).nearness();
    const OperationalInertia Lambda(A, T(near / T(500)));
    CHECK(Lambda.positive_definite());
    if (near > 0) continue;
    const Load<T> F{{at.dq[0], at.dq[1], at.dq[2]}, {at.dq[3], at.dq[4], at.dq[5]}};
    const Load<T> back = Lambda * (A * F);
    const T wanted[6] = {F.force.x, F.force.y, F.force.z, F.moment.x, F.moment.y, F.moment.z};
    const T got[6] = {back.force.x, back.force.y, back.force.z, back.moment.x, back.moment.y, back.moment.z};
    worst_inverse = std::max(worst_inverse, relative_error(got, wanted, 6));
    // A push moves the joints as forward dynamics says.
    const auto tau = transpose(J) * F;
    const auto a = (A * F).linear,
               b = (J * JointVelocity<6, T>(std::to_array(mass_factors(at.q).solve(tau).data))).linear;
    CHECK(std::abs(double(a.x - b.x)) <= 1e4 * eps * (1 + std::abs(double(b.x))));
  }
  CHECK(worst <= 2e3 * eps);
  CHECK(worst_inverse <= 1e6 * eps);
}

TEST_CASE("effective_mass: what a push feels, and never more than the heaviest") {
  // One prismatic joint along z carrying 4 kg shows 4 kg along z and no give across.
  const CalibratedModel<Slider> slider({make_link({}, {4, {0, 0, 0}, 0.1, 0.1, 0.1})});
  const JointPosition<1> q(std::array<double, 1>{0.3});
  const auto J = jacobian<0>(link_poses(slider, q));
  const auto A = operational_mobility(J, MassFactors<CalibratedModel<Slider>>(mass_matrix(slider, q)));
  CHECK(effective_mass(A, Xyz<double>{0, 0, 1}, 500.0) == doctest::Approx(4));
  CHECK(effective_mass(A, Xyz<double>{1, 0, 0}, 500.0) == doctest::Approx(500));
  CHECK(effective_mass(A, Xyz<double>{0.6, 0, 0.8}, 500.0) == doctest::Approx(4 / 0.64));
}

TEST_CASE_TEMPLATE("OperationalInertia: bounded at the singularities of a UR5", T, float, double) {
  for (double off : {0.0, 1e-6, 1e-3, 0.02})
    for (const JointPosition<6>& pose : {JointPosition<6>{0.3, -1.1, 1.4, -0.7, off, 0.5},
                                         JointPosition<6>{0.3, -1.1, off, -0.7, 1.2, 0.5}}) {
      const auto q = pose.cast<T>();
      const auto J = flange_jacobian(q);
      const auto A = operational_mobility(J, mass_factors(q));
      const T near = damped_inverse(J, SingularityDamping<T>()).nearness();
      CHECK(near > T(0.5));
      const OperationalInertia Lambda(A, T(near / T(500)));
      CHECK(Lambda.positive_definite());
      for (std::size_t k = 0; k < 3; ++k) {
        Rise<T> a;
        (k == 0 ? a.linear.x : k == 1 ? a.linear.y : a.linear.z) = T(1);
        const auto F = Lambda * a;
        CHECK(dot(F.force, F.force) + dot(F.moment, F.moment) <= T(510 * 510) / (near * near));
        CHECK(effective_mass(A, a.linear, T(500)) <= static_cast<T>(500.001));
      }
    }
}

TEST_CASE("OperationalMobility: MuJoCo agrees, of the flange and of a link further in") {
  const auto check = [](const auto& robot, auto link) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    using Model = typename std::remove_cvref_t<decltype(robot)>::Model;
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(3);
    double worst = 0;
    for (int k = 0; k < 200; ++k) {
      const Motion<N> at(random);
      const auto J = jacobian<link.value>(link_poses(robot.model, at.q));
      const auto A = operational_mobility(J, MassFactors<Model>(mass_matrix(robot.model, at.q)));
      double rows[36], expected[36];
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t s = 0; s < 6; ++s) rows[r * 6 + s] = A(r, s);
      mujoco.mobility(int(link.value), at.q.data, expected);
      worst = std::max(worst, relative_error(rows, expected, 36));
    }
    CHECK(worst <= 1e-12);
  };
  check(ur5_robot(), std::integral_constant<std::size_t, 5>{});
  check(ur5_robot(), std::integral_constant<std::size_t, 3>{});
}
