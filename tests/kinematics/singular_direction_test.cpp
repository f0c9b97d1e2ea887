#include "skinctl/kinematics/singular_direction.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/SVD>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::test;

namespace {
template <class T>
auto flange_jacobian(const JointPosition<6, T>& q) {
  const ur5::Model model;
  return jacobian<5>(link_poses(model, q),
                     Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6)));
}
}  // namespace

TEST_CASE("SingularDirection: is the least singular vector of J, near and at singularities") {
  for (const double off : {0.0, 1e-9, 1e-5, 1e-3, 0.03})
    for (const auto& q : {JointPosition<6>{0.3, -1.1, 1.4, -0.7, off, 0.5},
                          JointPosition<6>{0.3, -1.1, off, -0.7, 1.2, 0.5}}) {
      const auto J = flange_jacobian(q);
      const Eigen::JacobiSVD<Eigen::Matrix<double, 6, 6>> svd(Eigen::Matrix<double, 6, 6>(J.matrix()),
                                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
      const auto d = singular_direction(J, JointVelocity<6>{});
      CAPTURE(off);
      CHECK(std::abs(d.sigma - svd.singularValues()[5]) <= 1e-6);
      CHECK(std::abs(as_eigen(d.u).dot(svd.matrixU().col(5))) == doctest::Approx(1).epsilon(1e-6));
      CHECK(std::abs(as_eigen(d.v).dot(svd.matrixV().col(5))) == doctest::Approx(1).epsilon(1e-6));
      CHECK(as_eigen(d.u).dot(as_eigen(J * d.v)) >= -1e-9);
      // bend: what is left of the velocity along u after a small step along v, on either side.
      if (off == 0) {
        const double h = 1e-4;
        const auto ahead = flange_jacobian(integrate(q, d.v, h));
        CHECK(as_eigen(d.u).dot(as_eigen(ahead * d.v)) / h == doctest::Approx(d.bend).epsilon(1e-3));
      }
    }
}

TEST_CASE("SingularDirection: at the stretched elbow the tool can only come back, along either sign of v") {
  const auto J = flange_jacobian(JointPosition<6>{0.3, -1.1, 0, -0.7, 1.2, 0.5});
  auto near = JointVelocity<6>{0, 0, 1, 0, 0, 0};
  const auto a = singular_direction(J, near);
  const auto b = singular_direction(J, JointVelocity<6>(-near));
  CHECK(a.v[2] > 0);
  CHECK(b.v[2] < 0);
  CHECK(a.bend == doctest::Approx(b.bend));
  CHECK(std::abs(a.bend) > 0.05);
  const auto X = link_poses(ur5::Model{}, JointPosition<6>{0.3, -1.1, 0, -0.7, 1.2, 0.5});
  const auto wrist = X.get<3>().origin();
  CHECK(a.bend * dot(a.u.linear, wrist) < 0);  // towards the base
}
