#include "skinctl/kinematics/damped_inverse.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <type_traits>
#include <vector>

#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

template <class T>
using Speed = Twist<Flange, Base, Flange, Base, T>;
template <class T>
using Rise = Acceleration<Flange, Base, Flange, Base, T>;

template <class T>
auto ur5_jacobian(const JointPosition<6, T>& q) {
  static const auto model = calibrated_from<ur5::Description, T>();
  return jacobian<5>(link_poses(model, q),
                     Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6)));
}

/// Next to, and at, the UR5's singularities: wrist (q4 = 0), elbow (q2 = 0, stretched), shoulder (wrist
/// centre on the axis of joint 0), each at `off` from it.
std::vector<JointPosition<6>> singular_poses(double off) {
  using D = ur5::Description;
  std::vector<JointPosition<6>> poses;
  poses.push_back({0.3, -1.1, 1.4, -0.7, off, 0.5});
  poses.push_back({0.3, -1.1, off, -0.7, 1.2, 0.5});
  // Wrist centre (origin of frame 5) above the base: bisect the distance along the arm over q1.
  const auto reach = [&](double q1) {
    const double q2 = 1.9, q3 = 0.4, q123 = q1 + q2 + q3;
    return D::a2 * std::cos(q1) + D::a3 * std::cos(q1 + q2) + D::d5 * std::sin(q123);
  };
  double low = -3, high = 0;
  for (double q = -3; q < 0; q += 0.05)
    if (reach(q) * reach(q + 0.05) < 0) low = q, high = q + 0.05;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (reach(low) * reach(middle) <= 0 ? high : low) = middle;
  }
  poses.push_back({0.3, low + off, 1.9, 0.4, 1.2, 0.5});
  return poses;
}

}  // namespace

TEST_CASE_TEMPLATE("DampedInverse: away from singularities it is the inverse, undamped", T, float, double) {
  oracle::Random random(1);
  double worst = 0;
  int regular = 0;
  for (int k = 0; k < 300; ++k) {
    const Motion<6, T> at(random);
    const auto J = ur5_jacobian(at.q);
    const auto inverse = damped_inverse(J, SingularityDamping<T>());
    using std::abs;
    const double det = std::abs(as_eigen(J).template cast<double>().determinant());
    CHECK(std::abs(static_cast<double>(inverse.manipulability()) - det) <= 0.02 * 0.01 + 1e-3 * det);
    CHECK((inverse.damping() == 0) == (inverse.manipulability() >= static_cast<T>(0.004)));
    if (inverse.damping() > 0) continue;
    ++regular;
    const auto dq = inverse.solve(J * at.dq);
    worst = std::max(worst, relative_error(dq, at.dq, 6));
  }
  CHECK(regular > 180);
  CHECK(worst <= 2e4 * static_cast<double>(std::numeric_limits<T>::epsilon()));
}

TEST_CASE_TEMPLATE("DampedInverse: at singularities bounded, and reachable directions keep their speed", T,
                   float, double) {
  oracle::Random random(2);
  for (double off : {0.0, 1e-12, 1e-6, 1e-3, 0.01, 0.03, 0.1})
    for (const auto& q : singular_poses(off)) {
      const auto J = ur5_jacobian(q.cast<T>());
      const auto inverse = damped_inverse(J, SingularityDamping<T>());
      CAPTURE(off);
      if (off == 0) CHECK(inverse.manipulability() <= static_cast<T>(sizeof(T) == 8 ? 1e-7 : 2e-3));
      if (off <= 1e-3) CHECK(inverse.damping() > static_cast<T>(0.07));
      for (int k = 0; k < 20; ++k) {
        const Motion<6, T> at(random);
        const Speed<T> asked{{at.dq[0], at.dq[1], at.dq[2]}, {at.dq[3], at.dq[4], at.dq[5]}};
        const auto dq = inverse.solve(asked);
        const double gain = as_eigen(dq).norm() / static_cast<double>(as_eigen(asked).norm());
        CHECK(gain <= 80);
        // What the joints can do, they do to more than a tenth: along J dq.
        const Speed<T> possible = J * at.dq;
        const auto got = as_eigen(J * inverse.solve(possible)), wanted = as_eigen(possible);
        CHECK(got.dot(wanted) >= T(0.5) * wanted.dot(wanted));
      }
    }
}

TEST_CASE(
    "DampedInverse: its rate is the slope of what it asks, near singularities too, by quotients in 50 "
    "digits") {
  const Digits50 h("1e-16");
  oracle::Random random(3);
  double worst = 0, worst_float = 0;
  for (double off : {0.0, 1e-6, 1e-3, 0.01, 0.03, 1.0})
    for (const auto& q0 : singular_poses(off)) {
      const Motion<6> at(random);
      const JointPosition<6, float> q_f = q0.cast<float>();
      const JointPosition<6> q = q_f.cast<double>();  // the same number in both
      const JointVelocity<6> dq = at.dq.cast<float>().cast<double>();
      const Speed<double> dx{{0.5, -0.25, 1}, {0.125, 0.75, -0.5}};
      const Rise<double> ddx{{1, 0.5, -0.25}, {-0.5, 2, 0.25}};
      const auto asked = [&](const Digits50& t) {
        const auto J = ur5_jacobian(integrate(q.cast<Digits50>(), dq.cast<Digits50>(), t));
        const Speed<Digits50> v{cast<Digits50>(dx.linear) + t * cast<Digits50>(ddx.linear),
                                cast<Digits50>(dx.angular) + t * cast<Digits50>(ddx.angular)};
        return damped_inverse(J, SingularityDamping<Digits50>(Digits50(0.004), Digits50(0.08))).solve(v);
      };
      const auto ahead = asked(h), behind = asked(-h);
      Digits50 slope[6];
      for (std::size_t i = 0; i < 6; ++i) slope[i] = (ahead[i] - behind[i]) / (2 * h);
      const auto J = ur5_jacobian(q);
      const auto rate =
          damped_inverse(J, SingularityDamping<double>()).solve_rate(jacobian_rate(J, dq), dx, ddx);
      worst = std::max(worst, relative_error(rate, slope, 6));
      const auto J_f = ur5_jacobian(q_f);
      const auto rate_f = damped_inverse(J_f, SingularityDamping<float>())
                              .solve_rate(jacobian_rate(J_f, dq.cast<float>()),
                                          Speed<float>{cast<float>(dx.linear), cast<float>(dx.angular)},
                                          Rise<float>{cast<float>(ddx.linear), cast<float>(ddx.angular)});
      worst_float = std::max(worst_float, relative_error(rate_f, slope, 6));
    }
  CHECK(worst <= 1e-11);
  CHECK(worst_float <= 0.01);
}

TEST_CASE("DampedInverse: seven joints take the least speed, four the least error; their rates are slopes") {
  const auto check = [](const auto& robot, auto link) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::Random random(4);
    const Motion<N> at(random);
    const auto jacobian_at = [&](const JointPosition<N>& q) {
      return jacobian<link.value>(link_poses(robot.model, q));
    };
    using J_type = decltype(jacobian_at(at.q));
    using V = typename DampedInverse<J_type>::Velocity;
    using A = typename DampedInverse<J_type>::BodyAcceleration;
    const SingularityDamping<double> damping(10.0, 0.25);  // inside the zone everywhere
    const V dx{{0.5, -0.25, 1}, {0.125, 0.75, -0.5}};
    const A ddx{{1, 0.5, -0.25}, {-0.5, 2, 0.25}};
    const auto J = jacobian_at(at.q);
    const auto inverse = damped_inverse(J, damping);
    CHECK(inverse.damping() > 0);
    const Eigen::Matrix<double, 6, int(N)> dense = as_eigen(J);
    const Eigen::Matrix<double, int(N), int(N)> A_inverse =
        (dense.transpose() * dense +
         inverse.damping() * inverse.damping() * Eigen::Matrix<double, int(N), int(N)>::Identity())
            .inverse();
    const Eigen::Matrix<double, int(N), 1> expected = A_inverse * dense.transpose() * as_eigen(dx);
    CHECK(relative_error(inverse.solve(dx), expected.data(), N) <= 1e-10);

    const auto asked = [&](double t) {
      const auto at_t = jacobian_at(integrate(at.q, at.dq, t));
      return damped_inverse(at_t, damping).solve(V{dx.linear + t * ddx.linear, dx.angular + t * ddx.angular});
    };
    const double h = 1e-5;
    const auto change = asked(h) - asked(-h);
    const auto rate = inverse.solve_rate(jacobian_rate(J, at.dq), dx, ddx);
    for (std::size_t i = 0; i < N; ++i)
      CHECK(std::abs(change[i] / (2 * h) - rate[i]) <= 1e-6 * (1 + as_eigen(rate).norm()));
  };
  check(random_robot<Chain<7>>("chain of 7", 7), std::integral_constant<std::size_t, 6>{});
  check(random_robot<MixedTree>("mixed tree", 11), std::integral_constant<std::size_t, 4>{});
}

TEST_CASE("DampedInverse: of a position it takes the linear rows, and finds a load back from torques") {
  oracle::Random random(6);
  for (int k = 0; k < 50; ++k) {
    const Motion<6> at(random);
    const auto J = ur5_jacobian(at.q);
    const auto inverse = damped_inverse<TaskSpace::position>(J, SingularityDamping<double>(1e-4, 0.08));
    const Eigen::Matrix<double, 3, 6> J_v = as_eigen(J).topRows<3>();
    const Eigen::Matrix3d A = J_v * J_v.transpose();
    CHECK(inverse.manipulability() == doctest::Approx(std::sqrt(A.determinant())).epsilon(1e-9));
    if (inverse.damping() > 0) continue;
    const Speed<double> v{{0.3, -0.2, 0.5}, {9, 9, 9}};  // the angular part is not read
    const Eigen::Matrix<double, 6, 1> expected = J_v.transpose() * A.inverse() * as_eigen(v).head<3>();
    CHECK(relative_error(inverse.solve(v), expected.data(), 6) <= 1e-9);

    const Wrench<Flange, Flange, Base> F{{3, -2, 5}, {0.4, 0.1, -0.7}};
    const auto full =
        damped_inverse(J, SingularityDamping<double>(1e-6, 0.08)).solve_transposed(transpose(J) * F);
    CHECK(std::abs(full.force.x - F.force.x) + std::abs(full.moment.z - F.moment.z) < 1e-6);
    const auto force = inverse.solve_transposed(transpose(J) * Wrench<Flange, Flange, Base>{F.force, {}});
    CHECK(std::abs(force.force.y - F.force.y) < 1e-9);
    CHECK(force.moment.x == 0.0);

    const Rise<double> a{{1, 0.5, -0.25}, {}};
    const auto asked = [&](double t) {
      const auto moved = ur5_jacobian(integrate(at.q, at.dq, t));
      return damped_inverse<TaskSpace::position>(moved, SingularityDamping<double>(0.5, 0.1))
          .solve(Speed<double>{v.linear + t * a.linear, {}});
    };
    const double h = 1e-5;
    const auto change = asked(h) - asked(-h);
    const auto rate = damped_inverse<TaskSpace::position>(J, SingularityDamping<double>(0.5, 0.1))
                          .solve_rate(jacobian_rate(J, at.dq), v, a);
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(std::abs(change[i] / (2 * h) - rate[i]) <= 1e-6 * (1 + as_eigen(rate).norm()));
  }
}

TEST_CASE_TEMPLATE(
    "DampedInverse: outside of the zone a few units times the condition number, by blocks or not", T, float,
    double) {
  oracle::Random random(11);
  using Wide = Eigen::Matrix<long double, 6, 6>;
  double worst = 0, worst_transposed = 0, worst_flat = 0;
  int flat = 0;
  const auto units = [](const auto& is, const auto& should, const Wide& J, const Wide& back, int power) {
    const long double condition = J.norm() * back.norm();
    const long double error = (is.template cast<long double>() - should).norm() / should.norm();
    return double(error / (std::pow(condition, power) * (long double)std::numeric_limits<T>::epsilon()));
  };
  for (int k = 0; k < 600; ++k) {
    Motion<6, T> at(random);
    // Axes of the last three joints that are nearly in a plane: on both sides of the change to the product.
    if (k % 3 == 0) at.q[4] = static_cast<T>(random.uniform(0.004, 0.02));
    const bool in_plane = std::abs(std::sin(at.q[4])) < T(0.0102);
    const auto J = ur5_jacobian(at.q);
    const SingularityDamping<T> damping(T(1e-5), T(0.08));
    const auto inverse = damped_inverse(J, damping);
    const Wide dense = as_eigen(J).template cast<long double>(), back = dense.inverse();
    if (inverse.damping() > 0 || dense.norm() * back.norm() > (sizeof(T) == 4 ? 300 : 1e5)) continue;
    const Speed<T> V{{at.dq[0], at.dq[1], at.dq[2]}, {at.dq[3], at.dq[4], at.dq[5]}};
    const Eigen::Matrix<long double, 6, 1> v = as_eigen(V).template cast<long double>(), dq = back * v;
    const auto solved = inverse.solve(V);
    const double is = units(as_eigen(solved), dq, dense, back, in_plane ? 2 : 1);
    const auto tau = JointTorque<6, T>::generate([&](std::size_t i) { return at.dq[i]; });
    const auto F = inverse.solve_transposed(tau);
    const Eigen::Matrix<long double, 6, 1> load =
        back.transpose() * as_eigen(tau).template cast<long double>();
    const double transposed = units(as_eigen(F), load, dense, back, in_plane ? 2 : 1);
    if (in_plane) {
      ++flat;
      worst_flat = std::max({worst_flat, is, transposed});
    } else {
      worst = std::max(worst, is), worst_transposed = std::max(worst_transposed, transposed);
    }
  }
  CAPTURE(worst);
  CAPTURE(worst_transposed);
  CAPTURE(worst_flat);
  CHECK((sizeof(T) == 4 || flat > 40));
  CHECK(worst <= 4);
  CHECK(worst_transposed <= 4);
  CHECK(worst_flat <= 1);
}
