// Promise: equations of fits are solved, and their eigenvalues found, singular or not; a link takes the
// inertia that was found
// Tried: matrices of 1 to 60 rows, twelve decades, indefinite, singular, not numbers: to 1e-14 of the
// matrix; ten numbers of each link of a UR5 to 1e-9; 1000 drawn bodies can exist. Also:
// `calibration/link_inertia_test.cpp`

#include "skinctl/calibration/detail/symmetric.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Eigenvalues over twelve decades, two of them alike, two negative if asked for.
Eigen::MatrixXd some_matrix(Random& rng, int n, bool positive) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < n; ++k) {
    Eigen::VectorXd v(n);
    for (int i = 0; i < n; ++i) v(i) = uniform(rng, -1.0, 1.0);
    const double size = k == 1 ? 1 : std::pow(10.0, -12.0 * k / n);
    A += (!positive && k % 3 == 2 ? -size : size) * v * v.transpose();
  }
  return 0.5 * (A + A.transpose());
}

}  // namespace

TEST_CASE("Symmetric matrices: eigenvectors are orthogonal, and give the matrix again") {
  auto rng = seeded(1);
  for (const int n : {1, 2, 3, 6, 15, 60}) {
    CAPTURE(n);
    const Eigen::MatrixXd A = some_matrix(rng, n, false);
    const detail::SymmetricEigen eigen(A);
    const Eigen::MatrixXd &V = eigen.vectors, one = Eigen::MatrixXd::Identity(n, n);
    CHECK((V.transpose() * V - one).norm() < 1e-14 * n);
    CHECK((V * eigen.values.asDiagonal() * V.transpose() - A).norm() < 1e-14 * n * A.norm());
    for (int k = 1; k < n; ++k) CHECK(eigen.values(k) >= eigen.values(k - 1));
    CHECK(eigen.largest() == eigen.values(n - 1));
  }
  const detail::SymmetricEigen zero(Eigen::MatrixXd::Zero(4, 4));
  CHECK(zero.values.norm() == 0);
  CHECK(zero.vectors == Eigen::MatrixXd::Identity(4, 4));
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  A(1, 2) = A(2, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(detail::SymmetricEigen(A).largest()));
}

TEST_CASE(
    "Symmetric matrices: Cholesky's factor, its solutions and determinant; what is not positive is told") {
  auto rng = seeded(2);
  for (const int n : {1, 3, 15, 60}) {
    CAPTURE(n);
    const Eigen::MatrixXd A = some_matrix(rng, n, true) + 1e-3 * Eigen::MatrixXd::Identity(n, n);
    const detail::Cholesky factor(A);
    REQUIRE(factor.positive());
    Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
    double log = 0;
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k <= i; ++k) L(i, k) = factor.factor(i, k);
      log += 2 * std::log(L(i, i));
    }
    CHECK((L * L.transpose() - A).norm() < 1e-14 * n * A.norm());
    CHECK((A * factor.inverse() - Eigen::MatrixXd::Identity(n, n)).norm() < 1e-10);
    CHECK(factor.log_determinant() == doctest::Approx(log));
    const Eigen::MatrixXd b = A.col(0);  // b' A^-1 b = A(0, 0)
    CHECK(factor.squared(b) == doctest::Approx(A(0, 0)));
  }
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  A(2, 2) = 0;
  CHECK(!detail::Cholesky(A).positive());
  A(2, 2) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!detail::Cholesky(A).positive());
  A(2, 2) = std::numeric_limits<double>::infinity();
  CHECK(!detail::Cholesky(A).positive());
}

TEST_CASE("Symmetric matrices: equations that are indefinite or singular are solved as far as they can be") {
  auto rng = seeded(3);
  for (const int n : {1, 4, 15, 60}) {
    CAPTURE(n);
    const Eigen::MatrixXd A = some_matrix(rng, n, false) + 0.1 * Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd x(n, 2);
    for (int i = 0; i < n; ++i) x(i, 0) = uniform(rng, -1.0, 1.0), x(i, 1) = uniform(rng, -1.0, 1.0);
    const Eigen::MatrixXd b = A * x;
    CHECK((A * detail::solve_symmetric(A, b) - b).norm() < 1e-11 * A.norm() * x.norm());
  }
  // A direction that nothing says anything about stays where it is.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3), b(3, 1);
  A(0, 0) = 2, A(2, 2) = 4;
  b << 2, 0, 8;
  CHECK(detail::solve_symmetric(A, b) == Eigen::MatrixXd(Eigen::Vector3d(1, 0, 2)));
}

TEST_CASE("Symmetric matrices: of what an equation leaves open, the shortest is taken") {
  Eigen::MatrixXd A(3, 3);  // says x + y = 2, of either nothing, and z = 4
  A << 1, 1, 0, 1, 1, 0, 0, 0, 0.5;
  const Eigen::VectorXd x = detail::shortest_solution(A, Eigen::Vector3d(2, 2, 2));
  CHECK((x - Eigen::Vector3d(1, 1, 4)).norm() < 1e-14);
}
