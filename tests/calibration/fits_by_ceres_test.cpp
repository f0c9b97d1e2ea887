// not sanitized: the fits of Eigen take this compiler minutes; least_squares_test holds a sample
// The fits of sightings and of patches against Ceres.
//
// Promise: sightings and patches are fitted where Ceres ends
// Tried: a fifth of the sightings wrong: every number of five poses within 5e-6; 14 cells with their
// sensors' errors: 2 um, 5e-5 rad; skipped, and said, without Ceres

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "bench/studies/worlds/skin_sightings.hpp"
#include "skinctl/calibration/reconstruction.hpp"
#include "skinctl/calibration/sighting.hpp"
#include "skinctl/testing/skin_at_rest.hpp"
#include "support/ceres_oracle.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

oracle::PlainPose plain(const FitPose& X) {
  oracle::PlainPose out{};
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) out[std::size_t(3 * i + j)] = X.R(i, j);
    out[std::size_t(9 + i)] = X.p(i);
  }
  return out;
}

}  // namespace

TEST_CASE("Sightings: Ceres ends where the fit does, wrong sightings and all") {
  auto rng = seeded(5);
  const SeenArm arm(rng);
  const auto views = arm.views(6, 0.5, 0.2, 0.6, rng);
  const std::vector<FitPose> placed = arm.placed(0.02, 0.1, rng);
  const SightingSettings s;
  const auto found = fit_sightings(arm.camera, arm.cells, {"0", "1", "2", "3"}, views, placed,
                                   {SeenArm::about(arm.X_BaseCam, 0.03, 0.04, rng)}, s);
  // Ceres begins beside the truth, and knows nothing of where the fit ended.
  std::vector<oracle::PlainPose> poses = {plain(SeenArm::about(arm.X_BaseCam, 1e-3, 1e-3, rng))};
  for (const auto& X : arm.placed(1e-3, 1e-3, rng)) poses.push_back(plain(X));
  std::vector<oracle::PlainSighting> lights;
  for (const auto& view : views)
    for (const auto& seen : view.seen) {
      const Eigen::Vector3d& p = arm.cells[seen.patch][seen.cell];
      lights.push_back({plain(view.X_BaseLink[seen.patch]),
                        {p.x(), p.y(), p.z()},
                        {seen.pixel.x(), seen.pixel.y()},
                        seen.patch});
    }
  CHECK(oracle::ceres_sightings({arm.camera.fx, arm.camera.fy, arm.camera.cx, arm.camera.cy}, lights, s.pixel,
                                s.outlier_residual, poses));
  double worst = 0;
  const auto differ = [&](const FitPose& a, const oracle::PlainPose& b) {
    const oracle::PlainPose mine = plain(a);
    for (std::size_t k = 0; k < 12; ++k) worst = std::max(worst, std::abs(mine[k] - b[k]));
  };
  differ(found.X_BaseCam.value, poses[0]);
  for (std::size_t i = 0; i < SeenArm::links; ++i) differ(found.X_LinkRoot[i].value, poses[1 + i]);
  double least = 1;
  for (const auto& X : found.X_LinkRoot)
    for (Eigen::Index k = 0; k < 6; ++k) least = std::min(least, std::sqrt(X.covariance(k, k)));
  MESSAGE("largest difference of a number of a pose: " << worst
                                                       << " m or rad; least deviation of one: " << least);
  // Both end where another step gains little.
  CHECK(worst < 5e-6);
  CHECK(worst < 0.05 * least);
}

TEST_CASE("Reconstruction: Ceres ends where the fit does, sensor errors and all") {
  auto rng = seeded(6);
  const SimulatedAccelerometer sensor;
  const PatchAtRest truth = tube(0.045, 0.08, 14, sensor, rng);
  const auto up = cube_corners(rng);
  const RestReadings y = rest_readings(truth, up, sensor, rng);
  const ReconstructionSettings s;
  const auto found = reconstruct(truth.graph, y, s);
  REQUIRE(found.end == FitEnd::converged);

  oracle::PlainPatch patch;
  const auto array_of = [](const Eigen::Vector3d& v) { return std::array<double, 3>{v.x(), v.y(), v.z()}; };
  for (const auto& cell : y) {
    auto& own = patch.readings.emplace_back();
    for (const auto& r : cell) own.push_back(array_of(r));
  }
  for (const auto& j : truth.graph.joints)
    patch.joints.push_back({j.a, j.b, array_of(s.ports[j.port_a]), array_of(s.ports[j.port_b])});
  patch.reading = s.reading, patch.gap = s.gap;
  patch.bias = s.prior.bias, patch.scale = s.prior.scale, patch.misalignment = s.prior.misalignment;
  // From beside the truth, the first cell apart.
  const FitPose root{truth.cells[0].R, truth.cells[0].p};
  std::vector<oracle::PlainPose> cells;
  for (const auto& c : truth.cells) {
    const FitPose X = root.inverse() * FitPose{c.R, c.p};
    cells.push_back(plain(cells.empty() ? X : SeenArm::about(X, 1e-3, 0.02, rng)));
  }
  std::vector<std::array<double, 3>> vertical;
  for (const auto& u : up) vertical.push_back(array_of(root.R.transpose() * u));
  CHECK(oracle::ceres_patch(patch, cells, vertical));
  double place = 0, turned = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const oracle::PlainPose mine = plain({found.cells[i].R, found.cells[i].p});
    for (std::size_t k = 0; k < 12; ++k)
      (k < 9 ? turned : place) = std::max(k < 9 ? turned : place, std::abs(mine[k] - cells[i][k]));
  }
  MESSAGE("largest difference: " << 1e3 * place << " mm, " << turned << " rad");
  CHECK(place < 2e-6);
  CHECK(turned < 5e-5);
}
