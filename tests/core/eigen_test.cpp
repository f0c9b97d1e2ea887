#include "skinctl/core/eigen.hpp"

#include <doctest/doctest.h>

#include <type_traits>

using namespace skinctl;

static_assert(std::is_same_v<Vec3<double>, Eigen::Vector3d> && std::is_same_v<Mat3<float>, Eigen::Matrix3f>);
static_assert(Vec6<double>::SizeAtCompileTime == 6 && Mat6<double>::SizeAtCompileTime == 36);

TEST_CASE_TEMPLATE("as_eigen: a joint vector is seen in place, without a copy", T, float, double) {
  JointTorque<3, T> tau{T(1), T(2), T(3)};
  CHECK(as_eigen(tau).data() == tau.data);
  as_eigen(tau)(1) = T(5);
  CHECK(tau[1] == T(5));
  const JointTorque<3, T>& constant = tau;
  CHECK(as_eigen(constant).data() == tau.data);
  static_assert(!std::is_assignable_v<decltype(as_eigen(constant)(0)), T>);
  CHECK(as_eigen(constant).sum() == T(9));
  CHECK(JointTorque<3, T>(as_eigen(constant)) == tau);
}

TEST_CASE_TEMPLATE("as_eigen: a triple there and back is the same", T, float, double) {
  const Xyz<T> v{T(1), T(2), T(3)};
  CHECK(as_eigen(v) == Vec3<T>(T(1), T(2), T(3)));
  CHECK(as_xyz(as_eigen(v)) == v);
}
