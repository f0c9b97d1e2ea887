#include "skinctl/tracking/damping.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>

#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/largest_eigenvalue.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Matrix = Matrix66;
using Vector = Eigen::Vector<double, 6>;

Matrix random_spd(Seeded& rng, double size) {
  Matrix a;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) a(i, j) = rng();
  return size * (a * a.transpose() + 0.1 * Matrix::Identity());
}
std::array<double, 36> rows(const Matrix& m) {
  std::array<double, 36> r;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) r[std::size_t(6 * i + j)] = m(i, j);
  return r;
}
}  // namespace

TEST_CASE("ConstantDamping: computes K_d S_q and M^-1 K_d S_q, against Eigen") {
  const ur5::Model model;
  Seeded rng(40);
  for (int k = 0; k < 100; ++k) {
    const Matrix K_d = random_spd(rng, 0.01);
    const ConstantDamping<6> damping(model, rows(K_d));
    const State<6> state{0ns, rng.vector<JointPosition<6>>(3), rng.vector<JointVelocity<6>>(1)};
    const NoTouch none;
    const Quantities<ur5::Model, ConstantDamping<6>::needs> known(model, state, 0.002, none);
    const Matrix M = Eigen::Map<const Matrix>(known.mass().data);
    const Vector S = as_eigen(state.dq);
    const auto tau = damping.torque(state.dq);
    CHECK((as_eigen(tau) - K_d * S).norm() <= 1e-14 * (K_d * S).norm());
    const Vector a = M.llt().solve(K_d * S);
    const auto ddq = damping.acceleration(known, state.dq);
    CHECK((as_eigen(ddq) - a).norm() <= 1e-11 * a.norm());
  }
}

TEST_CASE("ConstantDamping: its fastest decay is the largest eigenvalue of M^-1 K_d anywhere") {
  const ur5::Model model;
  Seeded rng(41);
  const Matrix K_d = random_spd(rng, 0.05);
  const ConstantDamping<6> damping(model, rows(K_d));
  double largest = 0;
  for (int k = 0; k < 2000; ++k) {
    const Matrix M = Eigen::Map<const Matrix>(mass_matrix(model, rng.vector<JointPosition<6>>(3.1416)).data);
    largest = std::max(largest, largest_eigenvalue(K_d, M));
  }
  CHECK(damping.fastest() <= largest * 1.001);
  CHECK(damping.fastest() >= largest * 0.98);
}

TEST_CASE("ConstantDamping: refuses what is not symmetric, not positive definite or not finite") {
  const ur5::Model model;
  Seeded rng(42);
  const auto make = [&](const Matrix& m) { return ConstantDamping<6>(model, rows(m)); };
  CHECK_NOTHROW(make(0.01 * Matrix::Identity()));
  Matrix lopsided = 0.01 * Matrix::Identity();
  lopsided(3, 1) = 1e-3;
  CHECK_THROWS_WITH_AS(make(lopsided), "skinctl: K_d(i,j) - K_d(j,i) = 0.001, allowed: 0: symmetric",
                       ConfigurationError);
  Matrix indefinite = 0.01 * Matrix::Identity();
  indefinite(2, 2) = -0.5;
  CHECK_THROWS_WITH_AS(make(indefinite),
                       "skinctl: smallest eigenvalue of K_d = -0.5, allowed: > 0: positive definite",
                       ConfigurationError);
  CHECK_THROWS_AS(make(Matrix::Zero()), ConfigurationError);
  Matrix broken = Matrix::Identity();
  broken(5, 5) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(make(broken), ConfigurationError);
  // Symmetric with positive diagonal, and yet indefinite.
  Matrix sly = Matrix::Identity();
  sly(0, 1) = sly(1, 0) = 2;
  CHECK_THROWS_AS(make(sly), ConfigurationError);
}

TEST_CASE("ConstantDamping: the wrist bounds the whole arm") {
  const ur5::Model model;
  const ConstantDamping<6> same(model, rows(Matrix::Identity()));
  CHECK(same.fastest() > 3000);  // 1/s for 1 N m s/rad: 0.03 are the most that 100 1/s allow
  const InertialDamping<> shaped(100);
  CHECK(shaped.fastest() == 100);
}
