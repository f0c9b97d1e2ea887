// What operational control adds to poses and Jacobian: dJ dq, the damped inverse, and the rate of what it
// asks.
#include "bench/support/rows.hpp"
#include "skinctl/kinematics/damped_inverse.hpp"
#include "skinctl/model/ur5.hpp"

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

const bool registered = (rows<double>(), rows<float>(), true);

}  // namespace
