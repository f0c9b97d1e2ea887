#include "skinctl/kinematics/jacobian_rate.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// The rate of link `I`'s Jacobian, of a cell on it, against difference quotients in 50 digits: the largest
/// error relative to the largest element.
template <std::size_t I, class T, class R>
double worst_error(const R& robot, const auto& model) {
  constexpr std::size_t N = R::joints;
  const oracle::EulerLagrange<Digits50> exact(robot.table);
  oracle::Random random(4);
  double worst = 0;
  for (int k = 0; k < 10; ++k) {
    const Motion<N, T> at(random);
    const T p[3] = {T(0.125), T(-0.25), T(0.0625)};
    const T c = static_cast<T>(std::cos(robot.turn[I])), s = static_cast<T>(std::sin(robot.turn[I]));
    const auto X_LC =
        Transform<Link<I>, Cell, T>::translation_xyz(c * p[0] + s * p[1], c * p[1] - s * p[0], p[2]);
    const auto J = jacobian<I>(link_poses(model, at.q), X_LC);
    const auto dJ = jacobian_rate(J, at.dq);
    static_assert(decltype(dJ)::columns == ancestors<typename R::Model>(I) && sizeof dJ == sizeof J);
    const auto expected = exact.jacobian_rate(int(I), {Digits50(p[0]), Digits50(p[1]), Digits50(p[2])},
                                              wide(at.q), wide(at.dq));
    std::array<T, 6 * N> rows;
    const auto dense = as_eigen(dJ);
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t j = 0; j < N; ++j) rows[r * N + j] = dense(Eigen::Index(r), Eigen::Index(j));
    worst = std::max(worst, relative_error(rows, expected, 6 * N));

    const auto product = oracle::EulerLagrange<Digits50>::product(expected, wide(at.dq));
    const Vec6<T> of_matrix = as_eigen(dJ * at.dq), direct = as_eigen(bias_acceleration(J, at.dq));
    JointVelocity<N, T> other;
    for (std::size_t i = 0; i < N; ++i) other[i] = at.ddq[i];
    const Vec6<T> with_other = as_eigen(jacobian_rate_times(J, at.dq, other, J * at.dq));
    worst =
        std::max(worst, relative_error(with_other.data(),
                                       oracle::EulerLagrange<Digits50>::product(expected, wide(other)), 6));
    worst = std::max(worst, relative_error(of_matrix.data(), product, 6));
    worst = std::max(worst, relative_error(direct.data(), product, 6));
    // With accelerations: J ddq on top.
    const Vec6<T> change = as_eigen(acceleration(J, at.dq, at.ddq)) - direct;
    const Vec6<T> J_ddq = as_eigen(J) * as_eigen(at.ddq);
    CHECK((change - J_ddq).norm() <=
          T(64) * std::numeric_limits<T>::epsilon() * (direct.norm() + J_ddq.norm()));
  }
  return worst;
}

}  // namespace

TEST_CASE("JacobianRate: it is the slope of the Jacobian along the motion, by quotients in 50 digits") {
  const auto arm = ur5_robot();
  CHECK(worst_error<5, double>(arm, arm.model) <= 4e-15);
  CHECK(worst_error<3, double>(arm, arm.model) <= 4e-15);
  CHECK(worst_error<5, float>(arm, arm.model) <= 2e-6);
  const auto tree = random_robot<MixedTree>("mixed tree", 11);
  CHECK(worst_error<4, double>(tree, tree.model) <= 2e-14);  // carries the rounding of canonical_links
  CHECK(worst_error<8, double>(tree, tree.model) <= 2e-14);
}

TEST_CASE("JacobianRate: KDL agrees at 1000 states") {
  const auto arm = ur5_robot();
  oracle::KdlOracle kdl(arm.table);
  oracle::Random random(6);
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const Motion<6> at(random);
    double expected[36];
    kdl.jacobian_rate(at.q.data, at.dq.data, expected);
    const auto dJ = jacobian_rate(jacobian<5>(link_poses(arm.model, at.q)), at.dq);
    double rows[36] = {};
    dJ.for_each([&](auto j, const auto& c) {
      const double six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
      for (std::size_t r = 0; r < 6; ++r) rows[r * 6 + j.value] = six[r];
    });
    worst = std::max(worst, relative_error(rows, expected, 36));
  }
  CHECK(worst <= 1e-14);
}

TEST_CASE("JacobianRate: a motion at rest has none, and lanes do what numbers do") {
  using L = Lane<double>;
  const ur5::Model model;
  oracle::Random random(5);
  const Motion<6> at(random);
  const auto J = jacobian<5>(link_poses(model, at.q));
  CHECK(as_eigen(jacobian_rate(J, JointVelocity<6>())).norm() == 0);

  const auto J_lanes = jacobian<5>(link_poses(model, at.q.cast<L>()));
  const auto a_lanes = bias_acceleration(J_lanes, at.dq.cast<L>());
  const auto a = bias_acceleration(J, at.dq);
  CHECK(a_lanes.linear.x[0] == doctest::Approx(a.linear.x).epsilon(1e-13));
  CHECK(a_lanes.angular.z[0] == doctest::Approx(a.angular.z).epsilon(1e-13));
}

TEST_CASE_TEMPLATE("jacobian: J ddq + dJ dq is the acceleration", T, float, double) {
  oracle::Random random(17);
  for (int k = 0; k < 50; ++k) {
    const Motion<6, T> at(random);
    const auto J = jacobian<5>(link_poses(ur5::Model{}, at.q));
    const auto whole = acceleration(J, at.dq, at.ddq);
    const auto sum = J * at.ddq + jacobian_rate(J, at.dq) * at.dq;
    static_assert(std::is_same_v<decltype(sum), decltype(whole)>);
    CHECK((as_eigen(sum) - as_eigen(whole)).norm() <= T(8) * tolerance<T> * (T(1) + as_eigen(whole).norm()));
    const auto with_bias = J * at.ddq + bias_acceleration(J, at.dq);
    CHECK((as_eigen(with_bias) - as_eigen(whole)).norm() <=
          T(8) * tolerance<T> * (T(1) + as_eigen(whole).norm()));
  }
}
