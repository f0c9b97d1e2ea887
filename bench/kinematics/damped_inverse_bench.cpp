// What operational control adds to poses and Jacobian: dJ dq, the damped inverse, and the rate of what it
// asks.
#include <Eigen/Cholesky>
#include <memory>

#include "bench/support/rows.hpp"
#include "skinctl/kinematics/damped_inverse.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"

using namespace skinctl;

namespace {

template <class T>
void rows() {
  const std::string end = std::string("/ur5/skinctl/") + bench::scalar_name<T>;
  const auto J_of = [](const auto& s)
                        SKINCTL_INLINE_LAMBDA { return jacobian<5>(link_poses(ur5::Model{}, s.q)); };
  using V = Twist<Link<5>, Base, Link<5>, Base, T>;
  using A = Acceleration<Link<5>, Base, Link<5>, Base, T>;
  const SingularityDamping<T> damping;
  bench::row<6, T>("kinematics/jacobian-alone" + end, J_of);
  bench::row<6, T>("kinematics/jacobian-and-bias-acceleration" + end, [J_of](const auto& s) {
    const auto J = J_of(s);
    return bias_acceleration(J, s.dq);
  });
  bench::row<6, T>("kinematics/jacobian-and-rate" + end, [J_of](const auto& s) {
    const auto J = J_of(s);
    return jacobian_rate(J, s.dq);
  });
  bench::row<6, T>("kinematics/damped-inverse" + end, [J_of, damping](const auto& s) {
    const auto J = J_of(s);
    return damped_inverse(J, damping).solve(V{{s.dq[0], s.dq[1], s.dq[2]}, {s.dq[3], s.dq[4], s.dq[5]}});
  });
  bench::row<6, T>("kinematics/damped-inverse-and-rate" + end, [J_of, damping](const auto& s) {
    const auto J = J_of(s);
    const V dx{{s.dq[0], s.dq[1], s.dq[2]}, {s.dq[3], s.dq[4], s.dq[5]}};
    return damped_inverse(J, damping).solve_rate(jacobian_rate(J, s.dq), dx, A{dx.angular, dx.linear});
  });
}

/// The same from our Jacobian by Eigen, with constant damping; and KDL's own from q.
void twin_rows() {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;
  bench::row<6>("kinematics/damped-inverse/ur5/eigen/double", [](const auto& s) {
    const Matrix J = as_eigen(jacobian<5>(link_poses(ur5::Model{}, s.q)));
    const Matrix A = J.transpose() * J + 0.0064 * Matrix::Identity();
    const Vector b = J.transpose() * Eigen::Map<const Vector>(s.dq.data);
    return Vector(A.ldlt().solve(b));
  });
#if SKINCTL_HAS_KDL
  const auto kdl = std::make_shared<oracle::KdlOracle>(oracle::ur5());
  bench::row<6>("kinematics/damped-inverse/ur5/kdl/double", [kdl](const auto& s) {
    bench::Numbers<6> dq;
    kdl->damped_inverse(s.q.data, s.dq.data, 0.08, dq.data);
    return dq;
  });
  bench::row<6>("kinematics/jacobian-and-rate/ur5/kdl/double", [kdl](const auto& s) {
    bench::Numbers<36> dJ;
    kdl->jacobian_rate(s.q.data, s.dq.data, dJ.data);
    return dJ;
  });
#endif
}

const bool registered = (rows<double>(), rows<float>(), twin_rows(), true);

}  // namespace
