// SPDX-License-Identifier: BSD-3-Clause
// Where patches sit on their links, from a camera that sees the cells' lights while the robot takes several
// poses.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "skinctl/calibration/least_squares.hpp"
#include "skinctl/calibration/sighting_types.hpp"
#include "skinctl/calibration/turn.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

struct SightingProblem {
  using State = std::vector<FitPose>;  // camera first, then patches
  const PinholeCamera& camera;
  const std::vector<std::vector<Eigen::Vector3d>>& patches;
  const std::vector<CameraView>& views;
  double pixel = 1;
  Loss loss{};

  [[nodiscard]] int unknowns() const { return 6 + 6 * int(patches.size()); }
  [[nodiscard]] State plus(const State& x, const Eigen::VectorXd& d) const {
    State out = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      out[i].p += d.segment<3>(6 * int(i));
      out[i].R = straightened(x[i].R * turn(d.segment<3>(6 * int(i) + 3)));
    }
    return out;
  }
  /// Position of the light of a sighting in the camera's frame [m].
  [[nodiscard]] Eigen::Vector3d in_camera(const State& x, const CameraView& v, const Sighting& s) const {
    return x[0].inverse() * (v.X_BaseLink[s.patch] * (x[1 + s.patch] * patches[s.patch][s.cell]));
  }
  [[nodiscard]] Eigen::Vector2d on_image(const Eigen::Vector3d& p) const {
    return {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy};
  }
  template <class Sum>
  void terms(const State& x, Sum& sum) const {
    for (const auto& v : views)
      for (const auto& s : v.seen) {
        Eigen::Vector3d p = in_camera(x, v, s);
        // Behind the camera, or almost in it: as far off as a residual may be, without a slope.
        if (!(p.z() > 0.02)) {
          sum.add(loss, Eigen::Vector2d(2000 / pixel, 2000 / pixel));
          continue;
        }
        const Eigen::Vector2d r = (on_image(p) - s.pixel) / pixel;
        if constexpr (Sum::derivatives) {
          Eigen::Matrix<double, 2, 3> P;
          P << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0, camera.fy / p.z(),
              -camera.fy * p.y() / (p.z() * p.z());
          P /= pixel;
          const Eigen::Matrix3d R_CB = x[0].R.transpose(), R_CL = R_CB * v.X_BaseLink[s.patch].R;
          Eigen::Matrix<double, 2, 6> by_camera, by_patch;
          by_camera << -P * R_CB, P * cross_matrix(p);
          by_patch << P * R_CL, -P * R_CL * x[1 + s.patch].R * cross_matrix(patches[s.patch][s.cell]);
          sum.add(loss, r, {{0, by_camera}, {6 + 6 * int(s.patch), by_patch}});
        } else {
          sum.add(loss, r);
        }
      }
  }
};

}  // namespace detail

/// Fits the camera and all patches to all sightings of all views at once, with a Cauchy loss that narrows:
/// one view alone is ambiguous, because a patch is nearly flat. Each hypothesis of the camera's pose is
/// tried; the best few are fitted to the end, and the one with the lowest cost wins.
///
/// It needs poses that differ by two joints whose axes are not parallel. What they do not show is said by
/// name; a patch with too few sightings that agree as well.
///
/// Throws `ConfigurationError` for no hypothesis, sightings of cells that do not exist, or numbers that are
/// not finite.
///
/// @param patches  places of the cells' lights in each patch [m].
/// @param names    of the patches, for what is not observable.
/// @param placed   where a person has put the patches on their links: 30 mm and 15 deg off will do.
/// @param cameras  hypotheses of X_BaseCam: of each view's PnP, for instance.
[[nodiscard]] inline SightingFit fit_sightings(
    const PinholeCamera& camera, const std::vector<std::vector<Eigen::Vector3d>>& patches,
    const std::vector<std::string>& names, const std::vector<CameraView>& views,
    const std::vector<FitPose>& placed, const std::vector<FitPose>& cameras, const SightingSettings& s = {}) {
  require(!cameras.empty(), "sightings: hypotheses of the camera", 0, ">= 1");
  require(names.size() == patches.size() && placed.size() == patches.size(), "sightings: patches",
          double(placed.size()), "as many names and poses as patches");
  require(s.pixel > 0 && s.pixel < 100, "sightings: pixel", s.pixel, "0 to 100");
  require(s.refined_hypotheses >= 1 && s.refined_hypotheses <= 100, "sightings: refined_hypotheses",
          double(s.refined_hypotheses), "1 to 100");
  for (const auto& v : views) {
    require(v.X_BaseLink.size() == patches.size(), "sightings: links of a view", double(v.X_BaseLink.size()),
            "one for each patch");
    for (const auto& seen : v.seen) {
      require(seen.patch < patches.size(), "sightings: patch", double(seen.patch), "one that exists");
      require(seen.cell < patches[seen.patch].size(), "sightings: cell", double(seen.cell),
              "one that exists");
      require(seen.pixel.allFinite(), "sightings: pixel", seen.pixel.sum(), "finite");
    }
  }
  detail::SightingProblem problem{camera, patches, views};
  using State = detail::SightingProblem::State;
  const auto fitted = [&](State x, double pixel, double width, int steps) {
    problem.pixel = pixel;
    problem.loss = {Loss::Kind::cauchy, width};
    return least_squares(problem, std::move(x), {.steps = steps, .first_damping = 1e-3});
  };
  // Coarse: the camera and the patches by what most sightings say.
  struct Trial {
    double cost;
    std::size_t hypothesis;
    State state;
  };
  std::vector<Trial> trials;
  for (std::size_t h = 0; h < cameras.size(); ++h) {
    State x = {cameras[h]};
    x.insert(x.end(), placed.begin(), placed.end());
    const auto fit = fitted(std::move(x), 20 * s.pixel, 1, 8);
    if (fit.end != FitEnd::not_finite) trials.push_back({fit.cost, h, fit.state});
  }
  require(!trials.empty(), "sightings: hypotheses of the camera that are finite", 0, ">= 1");
  std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
  trials.resize(std::min(trials.size(), s.refined_hypotheses));
  Fit<State, DenseNormal> best{{}, {}};
  SightingFit out;
  for (auto& trial : trials) {
    State x = fitted(std::move(trial.state), 20 * s.pixel, 1, 30).state;
    for (const double pixel : {8.0, 3.0}) x = fitted(std::move(x), pixel * s.pixel, 1, 30).state;
    auto fit = fitted(std::move(x), s.pixel, s.outlier_residual, 60);
    if (best.state.empty() || fit.cost < best.cost) best = std::move(fit), out.hypothesis = trial.hypothesis;
  }

  out.agreeing.assign(patches.size(), 0);
  double squares = 0, count = 0;
  for (const auto& v : views)
    for (const auto& seen : v.seen) {
      const Eigen::Vector3d p = problem.in_camera(best.state, v, seen);
      const double off = p.z() > 0.02 ? (problem.on_image(p) - seen.pixel).norm() / s.pixel : 1e9;
      if (off > std::sqrt(2.0) * s.outlier_residual) {
        ++out.disagreeing;
        continue;
      }
      ++out.agreeing[seen.patch];
      squares += off * off, count += 2;
    }
  out.residual = count > 0 ? s.pixel * std::sqrt(squares / count) : 0;

  Eigen::VectorXd scale(problem.unknowns());
  for (int i = 0; i < scale.size(); i += 6)
    scale.segment<6>(i) << Eigen::Vector3d::Constant(s.place_limit), Eigen::Vector3d::Constant(s.turn_limit);
  const Observability known = best.normal.observed(scale, 1);
  const auto report = [&](std::size_t i, const std::string& name, std::size_t agreeing) {
    EstimateOf<FitPose, 6> e;
    e.value = best.state[i];
    e.covariance = known.covariance.block<6, 6>(6 * int(i), 6 * int(i));
    if (agreeing < s.min_sightings)
      e.unobservable.push_back({name + ": only " + std::to_string(agreeing) + " sightings agree",
                                {},
                                "m",
                                "more views in which it faces the camera"});
    // A part in a direction that is not seen, of more than a tenth of it.
    double turn = 0, place = 0;
    for (int k = 0; k < known.unseen.cols(); ++k) {
      const Eigen::Matrix<double, 6, 1> part = known.unseen.col(k).segment<6>(6 * int(i));
      place = std::max(place, part.head<3>().norm()), turn = std::max(turn, part.tail<3>().norm());
    }
    const std::string remedy = "views in which two joints with axes that are not parallel have moved";
    const double far = std::numeric_limits<double>::infinity();
    if (place > 0.1) e.unobservable.push_back({"place of " + name, far, "m", remedy});
    if (turn > 0.1) e.unobservable.push_back({"turn of " + name, far, "rad", remedy});
    return e;
  };
  std::size_t all = 0;
  for (const std::size_t n : out.agreeing) all += n;
  out.X_BaseCam = report(0, "the camera", all);
  for (std::size_t i = 0; i < patches.size(); ++i)
    out.X_LinkRoot.push_back(report(1 + i, names[i], out.agreeing[i]));
  return out;
}

SKINCTL_END_NAMESPACE
