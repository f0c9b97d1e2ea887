#include "skinctl/kinematics/singular_directions.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/SVD>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Matrix6 = Eigen::Matrix<double, 6, 6>;
template <class T>
auto flange_jacobian(const JointPosition<6, T>& q) {
  const ur5::Model model;
  return jacobian<5>(link_poses(model, q),
                     Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6)));
}
/// The arm straight up, `off` beside the first axis and bent by `off`: elbow and shoulder at once.
JointPosition<6> straight_up(double off) {
  return {0.3, -1.5707963267948966 + off, off, -1.5707963267948966, 1.2, 0.5};
}
}  // namespace

TEST_CASE("SingularDirections: the least singular vectors of J, near and at singularities") {
  for (const double off : {0.0, 1e-9, 1e-5, 1e-3, 0.03})
    for (const auto& q : {JointPosition<6>{0.3, -1.1, 1.4, -0.7, off, 0.5},
                          JointPosition<6>{0.3, -1.1, off, -0.7, 1.2, 0.5}}) {
      const auto J = flange_jacobian(q);
      const Eigen::JacobiSVD<Matrix6> svd(Matrix6(as_eigen(J)), Eigen::ComputeFullU | Eigen::ComputeFullV);
      const auto d = singular_directions(J)[0];
      CAPTURE(off);
      CHECK(std::abs(d.sigma - svd.singularValues()[5]) <= 1e-9);
      CHECK(std::abs(as_eigen(d.u).dot(svd.matrixU().col(5))) == doctest::Approx(1).epsilon(1e-6));
      CHECK(std::abs(as_eigen(d.v).dot(svd.matrixV().col(5))) == doctest::Approx(1).epsilon(1e-6));
      CHECK(as_eigen(d.u).dot(as_eigen(J * d.v)) >= -1e-12);
    }
}

TEST_CASE("SingularDirections: at the stretched elbow the tool can only come back") {
  const JointPosition<6> q{0.3, -1.1, 0, -0.7, 1.2, 0.5};
  const auto J = flange_jacobian(q);
  const auto d = singular_directions(J)[0];
  const double bend = as_eigen(d.u).dot(as_eigen(bias_acceleration(J, d.v)));
  CHECK(std::abs(d.v[2]) > 0.1);
  CHECK(std::abs(bend) > 0.05);
  CHECK(bend * dot(d.u.linear, link_poses(ur5::Model{}, q).get<3>().origin()) < 0);  // towards the base
}

TEST_CASE("SingularDirections: where elbow and shoulder meet, a plane of directions") {
  for (const double off : {0.0, 1e-12, 1e-9, 1e-6, 1e-4}) {
    const auto q = straight_up(off);
    const auto J = flange_jacobian(q);
    const Eigen::JacobiSVD<Matrix6> svd(Matrix6(as_eigen(J)), Eigen::ComputeFullU | Eigen::ComputeFullV);
    const auto d = singular_directions(J);
    CAPTURE(off);
    REQUIRE(svd.singularValues()[4] < 1e-3);
    using Plane = Eigen::Matrix<double, 6, 2>;
    const Plane u = svd.matrixU().rightCols<2>(), v = svd.matrixV().rightCols<2>();
    for (int k = 0; k < 2; ++k) {
      const auto& n = d[static_cast<std::size_t>(k)];
      CHECK(std::abs(n.sigma - svd.singularValues()[5 - k]) <= 1e-12);
      CHECK((as_eigen(J * n.v) - n.sigma * as_eigen(n.u)).norm() <= 1e-9);
      CHECK((u.transpose() * as_eigen(n.u)).norm() == doctest::Approx(1).epsilon(1e-9));
      CHECK((v.transpose() * as_eigen(n.v)).norm() == doctest::Approx(1).epsilon(1e-9));
    }
    CHECK(std::abs(as_eigen(d[0].u).dot(as_eigen(d[1].u))) <= 1e-12);
    CHECK(std::abs(as_eigen(d[0].v).dot(as_eigen(d[1].v))) <= 1e-12);
  }
}

TEST_CASE("SingularDirections: in float too, and of no number nothing") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& d : singular_directions(flange_jacobian(JointPosition<6>{0.3, nan, 1.4, -1.8, 0, 0.3})))
    for (const double v : d.v) CHECK(v == 0);
  const auto f =
      singular_directions(flange_jacobian(JointPosition<6, float>{0.3f, -1.1f, 1.4f, -0.7f, 0.0f, 0.5f}));
  CHECK(f[0].sigma < 1e-5f);
  CHECK(f[1].sigma > 0.1f);
}
