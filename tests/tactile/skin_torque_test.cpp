#include "skinctl/tactile/skin_torque.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "skinctl/dynamics/mass_matrix.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/random_skin.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// A random wrench on every link of the mask, and the sum of what each does to the joints by its own
/// Jacobian.
template <LinkMask Skinned, class M, class T, class Poses>
auto random_load(Random& rng, const M&, const Poses& poses, LinkWrenches<M, Skinned, T>& wrenches) {
  JointTorque<M::joints, T> expected;
  for_each_index<M::joints>([&](auto i) {
    if constexpr ((Skinned >> i.value) & 1u) {
      using L = Link<i.value>;
      const Wrench<L, L, L, T> F{random_xyz<T>(rng, T(20)), random_xyz<T>(rng, T(5))};
      wrenches.template set<i.value>(F);
      expected += transpose(jacobian<i.value>(poses)) * express(poses.template get<i.value>(), F);
    }
  });
  return expected;
}

}  // namespace

TEST_CASE_TEMPLATE("skin_torque: one pass back is the sum of the links' Jacobians", T, float, double,
                   Digits50) {
  Random rng = seeded(1);
  const ur5::Model model;
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    const auto q = random_position<6, T>(rng);
    const auto poses = link_poses(model, q);
    const auto check_mask = [&]<LinkMask Skinned>() {
      LinkWrenches<ur5::Model, Skinned, T> wrenches;
      const auto expected = random_load<Skinned>(rng, model, poses, wrenches);
      const auto [error, size] = compare(skin_torque(model, q, wrenches), expected);
      worst = std::max(worst, error / size);
    };
    check_mask.template operator()<0b111111>();
    check_mask.template operator()<0b000001>();
    check_mask.template operator()<0b010100>();
    check_mask.template operator()<0b100000>();
  }
  CHECK(worst <= 200 * static_cast<double>(epsilon<T>()));
}

TEST_CASE("skin_torque: works on every tree, with sliding joints and branches") {
  for_each_robot([](const auto& robot) {
    using M = typename std::remove_cvref_t<decltype(robot)>::Model;
    Random rng = seeded(2);
    double worst = 0;
    for (int k = 0; k < 100; ++k) {
      const auto q = random_position<M::joints, double>(rng);
      const auto poses = link_poses(robot.model, q);
      LinkWrenches<M, all_links(M::joints)> wrenches;
      const auto expected = random_load<all_links(M::joints)>(rng, robot.model, poses, wrenches);
      const auto [error, size] = compare(skin_torque(robot.model, q, wrenches), expected);
      worst = std::max(worst, error / size);
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-13);
  });
}

TEST_CASE(
    "skin_torque: joints behind the last link with skin get exactly nothing, and their angles are not read") {
  Random rng = seeded(3);
  const ur5::Model model;
  for (int k = 0; k < 50; ++k) {
    auto q = random_position<6, double>(rng);
    q[4] = q[5] = std::numeric_limits<double>::quiet_NaN();
    LinkWrenches<ur5::Model, 0b001010> wrenches;
    wrenches.set<1>({random_xyz(rng, 10.0), random_xyz(rng, 1.0)});
    wrenches.set<3>({random_xyz(rng, 10.0), random_xyz(rng, 1.0)});
    const auto tau = skin_torque(model, q, wrenches);
    CHECK(tau[4] == 0);
    CHECK(tau[5] == 0);
    for (std::size_t i = 0; i < 4; ++i) CHECK(std::isfinite(tau[i]));
  }
  static_assert(JointAngles<ur5::Model, double, 0b001010>::count == 4);
}

TEST_CASE("skin_torque: a robot without skin feels nothing") {
  struct NoSkin {};
  const ur5::Model model;
  const JointAngles<ur5::Model, double> angles(model, JointPosition<6>{1, 2, 3, 4, 5, 6});
  CHECK(skin_torque(model, angles, NoSkin{}) == JointTorque<6>{});
}

TEST_CASE("skin_torque: cell by cell it is KDL's Jacobian and ours") {
  for_each_robot([](const auto& robot) {
    using M = typename std::remove_cvref_t<decltype(robot)>::Model;
    constexpr std::size_t N = M::joints;
    oracle::KdlOracle kdl(robot.table);
    Random rng = seeded(4);
    double worst_kdl = 0, worst_own = 0;
    for (int k = 0; k < 20; ++k) {
      const auto q = random_position<N, double>(rng);
      const auto poses = link_poses(robot.model, q);
      LinkWrenches<M, all_links(N)> wrenches;
      JointTorque<N> by_kdl, by_own;
      for_each_index<N>([&](auto i) {
        const auto patch = random_patch<i.value, 5>(rng, 1);
        for (const auto& cell : patch.placed()) {
          const double newton = 10 + 10 * uniform<double>(rng);
          const auto before = wrenches.template wrench<i.value>();
          wrenches.template set<i.value>(before + newton * unit_wrench(cell.X_LC));
          by_own += torque_of_cell<i.value>(poses, robot.model, cell.X_LC, newton);
          // KDL's frame of the link is ours, turned by -turn about z; it speaks of the base's axes.
          const double c = std::cos(robot.turn[i.value]), s = std::sin(robot.turn[i.value]);
          const Xyz<double> p = cell.X_LC.origin();
          const double point[3] = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
          double J[6 * N];
          kdl.jacobian(int(i.value), point, q.data, J);
          const Xyz<double> n = (poses.template get<i.value>() * cell.X_LC).axis_z();
          for (std::size_t j = 0; j < N; ++j)
            by_kdl[j] -= newton * (J[j] * n.x + J[N + j] * n.y + J[2 * N + j] * n.z);
        }
      });
      const auto tau = skin_torque(robot.model, q, wrenches);
      const auto [error_kdl, size] = compare(tau, by_kdl);
      worst_kdl = std::max(worst_kdl, error_kdl / size);
      worst_own = std::max(worst_own, compare(tau, by_own).first / size);
    }
    CAPTURE(robot.name);
    CHECK(worst_kdl <= 1e-12);
    CHECK(worst_own <= 1e-12);
  });
}

TEST_CASE("skin_torque: on every link the arm moves away from the contact") {
  Random rng = seeded(5);
  const ur5::Model model;
  int moved[6] = {};
  for (int k = 0; k < 200; ++k) {
    const auto q = random_position<6, double>(rng);
    const auto poses = link_poses(model, q);
    const auto mass = mass_matrix(model, JointAngles<ur5::Model, double>(model, q));
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factors(
        Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(mass.data));
    for_each_index<6>([&](auto i) {
      const auto patch = random_patch<i.value, 3>(rng, 1, {}, 0.2);
      for (const auto& cell : patch.placed()) {
        LinkWrenches<ur5::Model, all_links(6)> wrenches;
        wrenches.template set<i.value>(15.0 * unit_wrench(cell.X_LC));
        const auto tau = skin_torque(model, q, wrenches);
        const Eigen::Matrix<double, 6, 1> ddq = factors.solve(as_eigen(tau));
        const auto J = as_eigen(jacobian<i.value>(poses, cell.X_LC));
        const Xyz<double> n = (poses.template get<i.value>() * cell.X_LC).axis_z();
        const double outward = as_eigen(n).dot((J * ddq).template head<3>());
        CAPTURE(i.value);
        // A push that the joints cannot feel (towards an axis) leaves rounding.
        if (as_eigen(tau).norm() > 1e-6) {
          CHECK(outward < 0);
          ++moved[i.value];
        } else {
          CHECK(std::abs(outward) < 1e-9);
        }
      }
    });
  }
  for (const int count : moved) CHECK(count > 500);
}
