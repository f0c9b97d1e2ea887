// Promise: the mass felt at a cell is that of the robot
// Tried: UR5, 5 to 40 cells a link, against MuJoCo: mobility to 1e-9

#include "skinctl/tactile/cell_mass.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("CellMasses: the mass at each cell is MuJoCo's, and the hardest collision that of the worst cell") {
  auto rng = seeded(8);
  const auto places = cell_places(ur5::skin_patches<60>());
  oracle::MujocoOracle mujoco(oracle::ur5());
  const ur5::Model model{};
  double worst = 0;
  for (int round = 0; round < 12; ++round) {
    JointPosition<6> q;
    JointVelocity<6> dq;
    for (auto& x : q) x = uniform(rng, -2.5, 2.5);
    for (auto& x : dq) x = uniform(rng, -2.0, 2.0);
    double M[36];
    mujoco.mass_matrix(q.data, M);
    const Eigen::Matrix<double, 6, 6> m =
        Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(&M[0]);
    const auto mass = m.llt();
    const auto poses = link_poses(model, q);
    const MassFactors<ur5::Model> factors(mass_matrix(model, q));
    const auto one = [&](auto link) {
      constexpr std::size_t L = link.value;
      const auto J = jacobian<L>(poses);
      const auto X = poses.template get<L>();
      const LinkMobility<> A(operational_mobility(J, factors), X);
      const CellMasses<> cells(places, L);
      const auto V = J * dq;
      const auto turned = [&](const Xyz<double>& x) {
        return Xyz<double>{dot(X.axis_x(), x), dot(X.axis_y(), x), dot(X.axis_z(), x)};
      };
      std::vector<double> out(cells.size());
      const AllocationGuard guard;
      cells.mobilities(A, out);
      const double hit = cells.hardest(A, turned(V.linear), turned(V.angular), 4);
      const double fastest = cells.fastest(turned(V.linear), turned(V.angular));
      const auto allocated = guard.count();
      CHECK(allocated == 0);
      std::size_t i = 0;
      double most = 0, speed = 0;
      for (const CellPlace& c : places) {
        if (c.link != L) continue;
        double J_P[36], R[9], p[3];
        const double point[3] = {c.place.x, c.place.y, c.place.z};
        mujoco.jacobian(int(L), point, q.data, J_P);
        mujoco.pose(int(L), q.data, R, p);
        const Eigen::Vector3d n = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R) *
                                  Eigen::Vector3d(c.normal.x, c.normal.y, c.normal.z);
        const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> all =
            Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(J_P);
        const Eigen::Matrix<double, 6, 1> row = all.topRows<3>().transpose() * n;
        const double give = row.dot(mass.solve(row));
        worst = std::max(worst, std::abs(out[i] - give) / (give + 1e-3));
        const double v = row.dot(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(dq.data));
        if (v > 0) most = std::max(most, v * v / (0.25 + give)), speed = std::max(speed, v);
        ++i;
      }
      CHECK(i == cells.size());
      CHECK(hit == doctest::Approx(most).epsilon(1e-6));
      CHECK(fastest == doctest::Approx(speed).epsilon(1e-6));
    };
    one(std::integral_constant<std::size_t, 1>{});
    one(std::integral_constant<std::size_t, 2>{});
    one(std::integral_constant<std::size_t, 5>{});
  }
  MESSAGE("mobility at a cell against MuJoCo: relative difference up to " << worst);
  CHECK(worst < 1e-9);
}

TEST_CASE("CellMasses: a cell that cannot move along its normal has no mobility") {
  // The first link turns about its z axis: a cell that looks along z, or towards the axis, stands still.
  const std::vector<CellPlace> places = {{0, 0, {0.06, 0.0, 0.1}, {0.0, 0.0, 1.0}},
                                         {0, 0, {0.06, 0.0, 0.1}, {1.0, 0.0, 0.0}},
                                         {0, 0, {0.06, 0.0, 0.1}, {0.0, 1.0, 0.0}}};
  const ur5::Model model{};
  const JointPosition<6> q{0.3, -1.2, 1.4, -1.8, -1.57, 0.3};
  const auto poses = link_poses(model, q);
  const LinkMobility<> A(
      operational_mobility(jacobian<0>(poses), MassFactors<ur5::Model>(mass_matrix(model, q))),
      poses.get<0>());
  double out[3];
  CellMasses<>(places, 0).mobilities(A, out);
  CHECK(std::abs(out[0]) < 1e-12);
  CHECK(std::abs(out[1]) < 1e-12);
  CHECK(out[2] > 1e-3);
}
