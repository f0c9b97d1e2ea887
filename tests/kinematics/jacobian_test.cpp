#include "skinctl/kinematics/jacobian.hpp"

#include <doctest/doctest.h>

#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <std::size_t N, class F>
void for_each_index(F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f(std::integral_constant<std::size_t, I>{}), ...);
  }(std::make_index_sequence<N>{});
}
}  // namespace

TEST_CASE("Jacobian: of every link, KDL, MuJoCo and the definition agree") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::KdlOracle kdl(robot.table);
    oracle::MujocoOracle mujoco(robot.table);
    const oracle::EulerLagrange<Digits50> exact(robot.table);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 100; ++k) {
      const Motion<N> at(random);
      const auto poses = link_poses(robot.model, at.q);
      for_each_index<N>([&](auto i) {
        // A cell somewhere on the link: the table's frame is the model's, turned by -turn.
        const double p[3] = {0.1, -0.2, 0.05};
        const double c = std::cos(robot.turn[i.value]), s = std::sin(robot.turn[i.value]);
        const auto X_LC =
            Transform<Link<i.value>, Cell>::translation_xyz(c * p[0] + s * p[1], c * p[1] - s * p[0], p[2]);
        const Eigen::Matrix<double, 6, int(N)> J = as_eigen(jacobian<i.value>(poses, X_LC));
        double expected[6 * N];
        const auto note = [&](const auto& row_major) {
          for (std::size_t r = 0; r < 6; ++r)
            for (std::size_t j = 0; j < N; ++j) {
              const double e =
                  std::abs(J(Eigen::Index(r), Eigen::Index(j)) - static_cast<double>(row_major[r * N + j]));
              if (!(e <= worst)) worst = e;
            }
        };
        kdl.jacobian(int(i.value), p, at.q.data, expected);
        note(expected);
        mujoco.jacobian(int(i.value), p, at.q.data, expected);
        note(expected);
        if (k == 0)
          note(exact.jacobian(int(i.value), {Digits50(p[0]), Digits50(p[1]), Digits50(p[2])}, wide(at.q)));
      });
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-12);
  });
}

TEST_CASE("Jacobian: it is the slope of the pose, by difference quotients in 50 digits") {
  const auto model = calibrated_from<ur5::Description, Digits50>();
  oracle::Random random(2);
  const Motion<6, Digits50> at(random);
  const auto poses = link_poses(model, at.q);
  const auto X_LF =
      Transform<Link<5>, Flange, Digits50>::translation_xyz(Digits50(0.1), Digits50(0.02), Digits50(0.3));
  const auto J = as_eigen(jacobian<5>(poses, X_LF));
  const Digits50 h("1e-16");
  for (std::size_t j = 0; j < 6; ++j) {
    auto q_plus = at.q, q_minus = at.q;
    q_plus[j] += h;
    q_minus[j] -= h;
    const auto X_plus = link_poses(model, q_plus).get<5>() * X_LF,
               X_minus = link_poses(model, q_minus).get<5>() * X_LF;
    const auto v = (X_plus.origin() - X_minus.origin());
    const auto w = log_so3(X_plus.axes() * X_minus.axes().transpose());
    const Digits50 slope[6] = {v.x, v.y, v.z, w.x, w.y, w.z};
    for (int r = 0; r < 6; ++r)
      CHECK(static_cast<double>(abs(slope[r] / (2 * h) - J(r, Eigen::Index(j)))) <= 1e-14);
  }
}

TEST_CASE("Jacobian: power in joints is power at the body, and zero columns are not stored") {
  const auto robot = random_robot<MixedTree>("mixed tree", 11);
  oracle::Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Motion<9> at(random);
    const auto poses = link_poses(robot.model, at.q);
    const auto J = jacobian<4>(poses);
    static_assert(decltype(J)::columns == 0b11011, "joints 0, 1, 3, 4 carry link 4");
    static_assert(sizeof J == 4 * 6 * sizeof(double));
    const Wrench<Link<4>, Link<4>, Base> F{{at.ddq[0], at.ddq[1], at.ddq[2]},
                                           {at.ddq[3], at.ddq[4], at.ddq[5]}};
    const JointTorque<9> tau = transpose(J) * F;
    CHECK(power(tau, at.dq) == doctest::Approx(power(F, J * at.dq)).epsilon(1e-12));
    CHECK(tau[2] == 0);
    CHECK(tau[5] == 0);
  }
}

TEST_CASE_TEMPLATE("jacobian: to Eigen and back is the same; J ddq is an acceleration", T, float, double) {
  const JointPosition<6, T> q{T(0), T(-1), T(1), T(-2), T(-1), T(0)};
  const auto J = jacobian<3>(link_poses(ur5::Model{}, q));
  using J_BL = std::remove_cvref_t<decltype(J)>;
  const auto E = as_eigen(J);
  CHECK(E.rightCols(2).norm() == T(0));
  CHECK(as_eigen(J_BL::from_eigen(E)) == E);
  const JointAcceleration<6, T> ddq{T(1), T(2), T(3), T(4), T(5), T(6)};
  const Acceleration<Link<3>, Base, Link<3>, Base, T> a = J * ddq;
  CHECK((E * as_eigen(ddq) - as_eigen(a)).norm() <= tolerance<T> * as_eigen(a).norm());
}
