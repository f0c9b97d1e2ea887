#include "skinctl/dynamics/operational_mobility.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include "tests/support/by_day.hpp"
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
}  // namespace

TEST_CASE_TEMPLATE("OperationalMobility: J M^-1 J'", T, SKINCTL_SCALARS) {
  const double eps = static_cast<double>(std::numeric_limits<T>::epsilon());
  oracle::Random random(1);
  double worst = 0;
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
  }
  CHECK(worst <= 2e3 * eps);
}

TEST_CASE("OperationalMobility: one over the mass that a push feels, 0 where nothing gives") {
  // One prismatic joint along z carrying 4 kg shows 4 kg along z and no give across.
  const CalibratedModel<Slider> slider({make_link({}, {4, {0, 0, 0}, 0.1, 0.1, 0.1})});
  const JointPosition<1> q(std::array<double, 1>{0.3});
  const auto J = jacobian<0>(link_poses(slider, q));
  const auto A = operational_mobility(J, MassFactors<CalibratedModel<Slider>>(mass_matrix(slider, q)));
  CHECK(A.along({0, 0, 1}) == doctest::Approx(1.0 / 4));
  CHECK(A.along({1, 0, 0}) == 0);
  CHECK(A.along({0.6, 0, 0.8}) == doctest::Approx(0.64 / 4));
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
