// not sanitized: the fits of Eigen take this compiler minutes; least_squares_test holds a sample
//
// Promise: a robot model from lines moves as KDL does, parallel axes or not
// Tried: a UR5 and axes off by 0.006 to 1 degree: 1e-9 m

#include "skinctl/calibration/line_model.hpp"

#include <doctest/doctest.h>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Pose = Eigen::Isometry3d;
Pose kdl_pose(oracle::KdlOracle& kdl, int body, const std::array<double, 6>& q) {
  double R[9], p[3];
  kdl.pose(body, q.data(), R, p);
  Pose out = Pose::Identity();
  out.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R);
  out.translation() = Eigen::Map<const Eigen::Vector3d>(p);
  return out;
}
template <std::size_t... I>
std::array<Pose, 6> poses_of(const ur5::Calibrated<>& model, const std::array<double, 6>& q,
                             std::index_sequence<I...>) {
  const auto at = link_poses(model, JointPosition<6>(q));
  return {as_eigen(at.get<I>())...};
}

}  // namespace

TEST_CASE(
    "A model from lines moves as KDL does: axes and points of KDL's UR5, exact and off by up to a degree") {
  auto rng = seeded(5);
  oracle::KdlOracle kdl(oracle::ur5());
  const std::array<double, 6> home{0.3, -1.1, 1.3, -0.9, -1.4, 0.5};
  std::array<AxisLine, 6> lines;
  std::array<Pose, 6> at_home;
  double J[36];
  const double origin[3] = {0, 0, 0};
  kdl.jacobian(5, origin, home.data(), J);
  for (std::size_t i = 0; i < 6; ++i) {
    at_home[i] = kdl_pose(kdl, int(i), home);
    lines[i] = {Eigen::Vector3d(J[18 + i], J[24 + i], J[30 + i]), at_home[i].translation()};
    // Any point of a line will do.
    lines[i].point += 0.3 * double(i) * lines[i].direction;
  }
  const auto found = line_model<6>(lines, home);
  const auto model = found.model<ur5::Description>();
  for (int k = 0; k < 50; ++k) {
    const auto q = random_array<6, double>(rng, 3.0);
    const auto now = poses_of(model, q, std::make_index_sequence<6>{});
    for (std::size_t i = 0; i < 6; ++i) {
      // A point of the link, 0.7 m off, at home; where it is now.
      const Eigen::Vector3d point = at_home[i].translation() + Eigen::Vector3d(0.3, -0.5, 0.4);
      const Eigen::Vector3d there = kdl_pose(kdl, int(i), q) * (at_home[i].inverse() * point);
      const Eigen::Vector3d ours = found.base * (now[i] * (found.at_home[i].inverse() * point));
      CHECK((there - ours).norm() < 1e-9);
    }
  }
  // The maker's table: three lengths that are no choice, and parallel axes that are named.
  CHECK(found.table[1].parallel);
  CHECK(found.table[2].parallel);
  CHECK(!found.table[3].parallel);
  CHECK(std::abs(found.table[1].a) == doctest::Approx(0.425));
  CHECK(std::abs(found.table[2].a) == doctest::Approx(0.39225));
  CHECK(std::abs(found.table[4].d) == doctest::Approx(0.09465));
  CHECK(std::abs(found.table[0].alpha) == doctest::Approx(1.5707963));
  MESSAGE(found.text());
}

TEST_CASE("A model from lines that are almost parallel is as exact") {
  auto rng = seeded(6);
  std::array<AxisLine, 6> lines;
  std::array<double, 6> home{};
  for (std::size_t i = 0; i < 6; ++i) {
    home[i] = uniform(rng, -1.0, 1.0);
    const Eigen::Vector3d tilt(uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0));
    const double size = i < 3 ? 1e-4 : 0.02;  // 0.006 to 1 degree
    lines[i].direction = (Eigen::Vector3d(0, i < 3 ? 1 : 0, i < 3 ? 0 : 1) + size * tilt).normalized();
    lines[i].point = Eigen::Vector3d(0.2 * double(i), 0.1, 0.05 * double(i)) + 0.01 * tilt;
  }
  const auto found = line_model<6>(lines, home);
  const auto model = found.model<ur5::Description>();
  for (int k = 0; k < 50; ++k) {
    const auto q = random_array<6, double>(rng, 3.0);
    const auto now = poses_of(model, q, std::make_index_sequence<6>{});
    // A product of turns about the lines at home.
    Pose X = Pose::Identity();
    for (std::size_t i = 0; i < 6; ++i) {
      const Pose turned = Eigen::Translation3d(lines[i].point) *
                          Eigen::AngleAxisd(q[i] - home[i], lines[i].direction) *
                          Eigen::Translation3d(-lines[i].point);
      X = X * turned;
      const Pose ours = found.base * now[i] * found.at_home[i].inverse();
      CHECK((X.matrix() - ours.matrix()).norm() < 1e-9);
    }
  }
}
