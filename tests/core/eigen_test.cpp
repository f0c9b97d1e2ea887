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

TEST_CASE_TEMPLATE("as_xyz: takes expressions and vectors of run-time size", T, float, double) {
  const Vec3<T> v(T(1), T(2), T(3));
  CHECK(as_xyz(v + v) == Xyz<T>{T(2), T(4), T(6)});
  const Eigen::Matrix<T, Eigen::Dynamic, 1> any = v;
  CHECK(as_xyz(any) == Xyz<T>{T(1), T(2), T(3)});
  const Mat3<T> R = T(2) * Mat3<T>::Identity();
  CHECK(as_xyz(R * v) == Xyz<T>{T(2), T(4), T(6)});
}

TEST_CASE_TEMPLATE("as_eigen: a joint vector is assigned to in place, and built from an expression", T, float,
                   double) {
  JointPosition<3, T> q;
  as_eigen(q) = Vec3<T>(T(1), T(2), T(3));
  CHECK(q == JointPosition<3, T>{T(1), T(2), T(3)});
  CHECK(JointPosition<3, T>(as_eigen(q) + as_eigen(q)) == q + q);
  const Eigen::Matrix<T, Eigen::Dynamic, 1> any = as_eigen(q);
  CHECK(JointPosition<3, T>(any) == q);
  CHECK(JointPosition<3, T>(any.transpose()) == q);
}

template <class Q>
concept viewed = requires(Q&& x) { as_eigen(static_cast<Q&&>(x)); };
static_assert(viewed<JointTorque<3>&> && viewed<const JointTorque<3>&>);
static_assert(!viewed<JointTorque<3>> && !viewed<const JointTorque<3>>, "no view of a temporary");
static_assert(viewed<Xyz<double>>, "a copy of a temporary is fine");
static_assert(!std::is_assignable_v<JointTorque<3>&, Eigen::Vector3d> &&
              !std::is_convertible_v<Eigen::Vector3d, JointTorque<3>> &&
              std::is_constructible_v<JointTorque<3>, Eigen::Vector3d>);
static_assert(!std::is_convertible_v<JointTorque<3>, Eigen::Vector3d> &&
              !std::is_assignable_v<Eigen::Vector3d&, JointTorque<3>>);
static_assert(!std::is_assignable_v<Xyz<double>&, Eigen::Vector3d> &&
              !std::is_convertible_v<Xyz<double>, Eigen::Vector3d>);
static_assert(std::is_trivially_copyable_v<JointTorque<3>> && std::is_trivially_copyable_v<Xyz<double>>);
