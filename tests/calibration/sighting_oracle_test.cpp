// not sanitized: the fits of Eigen take this compiler minutes; least_squares_test holds a sample
// The fit of sightings against Ceres.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/calibration/sighting.hpp"
#include "skinctl/testing/skin_sightings.hpp"
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
  std::vector<FitPose> placed;
  for (const auto& X : arm.X_LinkRoot) placed.push_back(SeenArm::about(X, 0.02, 0.1, rng));
  const SightingSettings s;
  const auto found = fit_sightings(arm.camera, arm.cells, {"0", "1", "2", "3"}, views, placed,
                                   {SeenArm::about(arm.X_BaseCam, 0.03, 0.04, rng)}, s);
  // Ceres begins beside the truth, and knows nothing of where the fit ended.
  std::vector<oracle::PlainPose> poses = {plain(SeenArm::about(arm.X_BaseCam, 1e-3, 1e-3, rng))};
  for (const auto& X : arm.X_LinkRoot) poses.push_back(plain(SeenArm::about(X, 1e-3, 1e-3, rng)));
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
                                s.wrong, poses));
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
