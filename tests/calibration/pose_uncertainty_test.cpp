// runs long: fits of random skins
#include "skinctl/calibration/pose_uncertainty.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/skin_at_rest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double deg = 0.0174532925;

Matrix6d diagonal(double place, double turn) {
  Vector6d d;
  d << Eigen::Vector3d::Constant(place * place), Eigen::Vector3d::Constant(turn * turn);
  return d.asDiagonal();
}

UncertainPatch patch_of(Random& rng, double own_place, double own_turn, double place, double turn_of_all) {
  UncertainPatch patch;
  const auto shape = tube(0.05, 0.15, 40, {}, rng);
  patch.X_LinkRoot = {turn(normal3(rng, 1)), normal3(rng, 0.1)};
  patch.covariance = diagonal(place, turn_of_all);
  const FitPose root{shape.cells[0].R, shape.cells[0].p};
  for (const auto& c : shape.cells)
    patch.cells.push_back({root.inverse() * FitPose{c.R, c.p}, diagonal(own_place, own_turn)});
  return patch;
}

// The patch as it may truly be.
UncertainPatch drawn(const UncertainPatch& mean, Random& rng) {
  UncertainPatch out = mean;
  const auto move = [&](FitPose& X, const Matrix6d& C) {
    X.p += normal3(rng, std::sqrt(C(0, 0)));
    X.R = X.R * turn(normal3(rng, std::sqrt(C(3, 3))));
  };
  move(out.X_LinkRoot, mean.covariance);
  for (auto& c : out.cells) move(c.X_RootCell, c.covariance);
  return out;
}

}  // namespace

TEST_CASE("Pose uncertainty: the covariance of the torque is that of ten thousand drawn patches") {
  auto rng = seeded(1);
  const auto mean = patch_of(rng, 1e-3, 1 * deg, 2e-3, 0.5 * deg);
  Eigen::MatrixXd T = Eigen::MatrixXd::Random(6, 6);
  std::vector<double> readings(40, 0.0);
  for (int k = 0; k < 8; ++k) readings[std::size_t(4 * k)] = 1 + k % 3;
  const auto torque = [&](const UncertainPatch& p) {
    Vector6d u = Vector6d::Zero();
    for (std::size_t i = 0; i < readings.size(); ++i) u += readings[i] * unit_wrench(p.X_LinkCell(i));
    return Eigen::VectorXd(T * u);
  };
  const Eigen::VectorXd tau = torque(mean);
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(6, 6);
  const int draws = 10000;
  for (int k = 0; k < draws; ++k) {
    const Eigen::VectorXd d = torque(drawn(mean, rng)) - tau;
    seen += d * d.transpose() / draws;
  }
  const Eigen::MatrixXd said = torque_covariance(T, mean, readings);
  CHECK((said - seen).norm() < 0.06 * said.norm());
  CHECK(std::abs(said.trace() / seen.trace() - 1) < 0.04);
}

TEST_CASE(
    "Pose uncertainty: what is known to 2 mm and 0.5 deg counts, what a hand placed to 30 mm and 15 deg is "
    "masked") {
  auto rng = seeded(2);
  std::vector<Eigen::MatrixXd> configurations;
  for (int k = 0; k < 5; ++k) {
    Eigen::MatrixXd T(3, 6);  // joints up to 0.5 m away
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d axis = normal3(rng, 1).normalized(), at = normal3(rng, 0.3);
      T.row(j) << axis.cross(-at).transpose(), axis.transpose();
    }
    configurations.push_back(T);
  }
  const auto good = patch_of(rng, 1e-3, 0.5 * deg, 2e-3, 0.5 * deg);
  const auto rough = patch_of(rng, 1e-3, 0.5 * deg, 0.06, 30 * deg);
  std::size_t masked = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    CHECK(mask_reason(configurations, good, i) == "");
    masked += !mask_reason(configurations, rough, i).empty();
  }
  CHECK(masked >= 36);
  CHECK(mask_reason(configurations, rough, 0).find("pose too uncertain: torque off by ") == 0);
  auto lost = good;
  lost.cells[3].covariance.setConstant(std::numeric_limits<double>::infinity());
  CHECK(mask_reason(configurations, lost, 3) == "pose unknown");
  CHECK_THROWS_AS((void)mask_reason(configurations, good, 0, 0), ConfigurationError);
}
