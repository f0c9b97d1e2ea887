// What a camera sees of the lights of a skin on an arm of which each link turns about an axis of its own.
#pragma once

#include <vector>

#include "skinctl/calibration/nees.hpp"
#include "skinctl/calibration/sighting.hpp"
#include "skinctl/testing/skin_at_rest.hpp"

namespace skinctl::testing {

/// A vertical, then horizontal axes: shoulder, elbow, wrist; lengths about a UR5's. A tube of skin on each
/// link.
struct SeenArm {
  static constexpr std::size_t links = 4;
  std::vector<std::vector<Eigen::Vector3d>> cells, normals;  ///< in each patch
  std::vector<FitPose> X_LinkRoot;
  FitPose X_BaseCam;
  PinholeCamera camera{};

  explicit SeenArm(Random& rng) {
    const double lengths[links] = {0.10, 0.30, 0.25, 0.08}, radii[links] = {0.06, 0.054, 0.04, 0.045};
    for (std::size_t i = 0; i < links; ++i) {
      const auto patch = tube(radii[i], lengths[i], 60, {}, rng);
      const FitPose root{patch.cells[0].R, patch.cells[0].p};
      auto& c = cells.emplace_back();
      auto& n = normals.emplace_back();
      for (const auto& cell : patch.cells) {
        c.push_back(root.inverse() * cell.p);
        n.push_back(root.R.transpose() * cell.R.col(2));
      }
      // Along the link, which points along its x, turned and moved as a person would glue it.
      FitPose X_LinkTube{turn({0, 1.5707963, 0}) * turn(normal3(rng, 0.3)),
                         {i == 0 ? 0 : 0.5 * lengths[i] + 0.06, 0, 0}};
      if (i == 0) X_LinkTube.R = turn(normal3(rng, 0.1));
      X_LinkRoot.push_back(X_LinkTube * root);
    }
    // 1.6 m in front, looking at the arm.
    const Eigen::Vector3d eye = Eigen::Vector3d(1.5, 0.3, 0.5) + normal3(rng, 0.1), at(0, 0, 0.35);
    const Eigen::Vector3d z = (at - eye).normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    X_BaseCam.R << x, z.cross(x), z;
    X_BaseCam.p = eye;
  }
  [[nodiscard]] std::vector<FitPose> poses(const std::vector<double>& q) const {
    FitPose shoulder{turn({0, 0, q[0]}), {0, 0, 0.09}};
    FitPose upper = shoulder * FitPose{turn({0, q[1], 0}), {0, 0.1, 0}};
    FitPose fore = upper * FitPose{turn({0, q[2], 0}), {0.425, -0.05, 0}};
    FitPose wrist = fore * FitPose{turn({0, 0, q[3]}), {0.39, 0.05, 0}};
    return {shoulder, upper, fore, wrist};
  }
  /// @param wrong    share of sightings that are of another cell or of nothing.
  /// @param missing  share of the lights in view that are not found.
  [[nodiscard]] CameraView view(const std::vector<double>& q, double pixel, double wrong, double missing,
                                Random& rng) const {
    CameraView v{poses(q), {}};
    detail::SightingProblem p{camera, cells, {}};
    detail::SightingProblem::State x = {X_BaseCam};
    x.insert(x.end(), X_LinkRoot.begin(), X_LinkRoot.end());
    for (std::size_t i = 0; i < links; ++i)
      for (std::size_t c = 0; c < cells[i].size(); ++c) {
        Sighting s{i, c, {}};
        const Eigen::Vector3d at = p.in_camera(x, v, s);
        const Eigen::Vector3d n =
            X_BaseCam.R.transpose() * v.X_BaseLink[i].R * X_LinkRoot[i].R * normals[i][c];
        if (n.dot(at.normalized()) > -0.25 || uniform<double>(rng, 0.0, 1.0) < missing) continue;
        s.pixel = p.on_image(at) + pixel * Eigen::Vector2d(normal(rng), normal(rng));
        if (s.pixel.x() < 0 || s.pixel.x() > 1280 || s.pixel.y() < 0 || s.pixel.y() > 960) continue;
        if (uniform<double>(rng, 0.0, 1.0) < wrong) {
          if (rng() % 2)
            s.cell = rng() % cells[i].size();  // a code that was misread
          else
            s.pixel = {uniform<double>(rng, 0.0, 1280.0), uniform<double>(rng, 0.0, 960.0)};
        }
        v.seen.push_back(s);
      }
    return v;
  }
  [[nodiscard]] std::vector<CameraView> views(int count, double pixel, double wrong, double missing,
                                              Random& rng) const {
    std::vector<CameraView> out;
    for (int k = 0; k < count; ++k)
      out.push_back(view({uniform<double>(rng, -1.2, 1.2), uniform<double>(rng, -1.6, -0.3),
                          uniform<double>(rng, -1.2, 1.2), uniform<double>(rng, -2.5, 2.5)},
                         pixel, wrong, missing, rng));
    return out;
  }
  /// All patches where a person has put them: so far off, each in a direction of its own.
  [[nodiscard]] std::vector<FitPose> placed(double place, double angle, Random& rng) const {
    std::vector<FitPose> out;
    for (const auto& X : X_LinkRoot) out.push_back(about(X, place, angle, rng));
    return out;
  }
  /// As far off as a person puts a marker.
  [[nodiscard]] static FitPose about(const FitPose& X, double place, double angle, Random& rng) {
    return {X.R * turn(angle * normal3(rng, 1).normalized()), X.p + place * normal3(rng, 1).normalized()};
  }
};

/// Of the patches' cells in their links: the root's error moves them all.
struct PlacementError {
  double place = 0, turn = 0;  ///< rms over patches [m], [rad]
  double nees = 0;             ///< mean over patches, over 6
};
[[nodiscard]] inline PlacementError placement_error(const SightingFit& found, const SeenArm& truth) {
  PlacementError out;
  for (std::size_t i = 0; i < SeenArm::links; ++i) {
    const FitPose &X = found.X_LinkRoot[i].value, &Y = truth.X_LinkRoot[i];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& c : truth.cells[i]) middle += c / double(truth.cells[i].size());
    Eigen::Matrix<double, 6, 1> e;
    e << X.p - Y.p, turn_vector(Y.R.transpose() * X.R);
    out.place += (X * middle - Y * middle).squaredNorm() / SeenArm::links;
    out.turn += e.tail<3>().squaredNorm() / SeenArm::links;
    out.nees += nees(e, found.X_LinkRoot[i].covariance) / 6 / SeenArm::links;
  }
  out.place = std::sqrt(out.place), out.turn = std::sqrt(out.turn);
  return out;
}

}  // namespace skinctl::testing
