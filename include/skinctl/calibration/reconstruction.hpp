// SPDX-License-Identifier: BSD-3-Clause
// The shape of a patch of skin, from what its cells feel of gravity while the robot rests in several poses.
#pragma once

#include <algorithm>
#include <cstdio>

#include "skinctl/calibration/detail/aligned_covariances.hpp"
#include "skinctl/calibration/detail/patch_fit.hpp"
#include "skinctl/calibration/detail/patch_start.hpp"
#include "skinctl/calibration/least_squares.hpp"
#include "skinctl/calibration/reconstruction_types.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Reconstructs a patch: rotations of neighbours by Procrustes as the start, then all poses, sensor errors
/// and directions of gravity together, with every connector as a tie. A cell is reported with the reason, and
/// its pose not used, if
/// - it was recorded in fewer than three poses, or its readings are not those of a sensor at rest (0.8 to 1.2
///   g);
/// - no neighbour's readings turn with its own: it lies, or its connector is a cable to another link;
/// - its turn or place is known worse than the limits: it was turned about gravity only, for instance.
///
/// A common factor on all distances is not observable: the ports' positions are taken as true.
///
/// Throws `ConfigurationError` for settings out of range, and where the numbers of cells or poses do not
/// agree.
[[nodiscard]] inline Reconstruction reconstruct(const PatchGraph& patch, const RestReadings& readings,
                                                const ReconstructionSettings& settings = {}) {
  detail::require_patch(patch, readings, settings);
  auto start = detail::patch_start(patch, readings, settings);
  Reconstruction out;
  const auto finish = [&] {
    out.cells = std::move(start.cells);
    for (const auto& c : out.cells)
      if (!c.unknown.empty())
        out.unobservable.push_back({"cell " + std::to_string(c.id) + " " + c.unknown, c.turn_deviation(),
                                    "rad", "rest in poses that tilt it about other axes"});
    return out;
  };
  if (start.used.empty()) return finish();

  std::vector<ReconstructedCell> cells;
  RestReadings used;
  std::vector<Eigen::Matrix3d> turns;
  for (const std::size_t i : start.used) {
    cells.push_back(start.cells[i]);
    used.push_back(readings[i]);
    turns.push_back(start.cells[i].R);
  }
  std::vector<Eigen::Vector3d> up(readings.front().size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t k = 0; k < up.size(); ++k)
      if (used[i][k].allFinite()) up[k] += cells[i].R * used[i][k];
  for (auto& u : up) u = u.norm() > 1e-3 ? u.normalized() : Eigen::Vector3d::UnitZ();
  const detail::PatchFit problem{start.joints, used, settings, turns};
  auto fit = least_squares<SparseNormal>(problem, {std::move(cells), std::move(up)}, {.steps = 60});
  out.end = fit.end;
  out.steps = fit.steps;
  if (fit.end == FitEnd::not_finite) {
    for (const std::size_t i : start.used) start.cells[i].unknown = "has readings that are no numbers";
    return finish();
  }
  detail::aligned_covariances(problem, fit.normal, fit.state.cells, settings);
  double squares = 0, count = 0;
  for (std::size_t q = 0; q < start.used.size(); ++q) {
    auto& cell = fit.state.cells[q];
    double own = 0, readings_of_it = 0;
    for (std::size_t k = 0; k < fit.state.up.size(); ++k)
      if (used[q][k].allFinite()) {
        own += (reading(cell.R, cell.errors, fit.state.up[k]) - used[q][k]).squaredNorm();
        readings_of_it += 3;
      }
    squares += own, count += readings_of_it;
    const auto text = [](double x) {
      char buffer[32];
      std::snprintf(buffer, sizeof buffer, "%.2g", x);
      return std::string(buffer);
    };
    const double turn_off = cell.turn_deviation(), place_off = cell.place_deviation();
    if (std::sqrt(own / readings_of_it) > 8 * settings.reading)
      cell.unknown = "has readings that contradict its neighbours by " +
                     text(1e3 * std::sqrt(own / readings_of_it)) + " mg";
    else if (!(turn_off <= settings.turn_limit))
      cell.unknown =
          "is turned by an unknown angle: to " + text(std::min(180.0, turn_off / 0.0174532925)) + " deg only";
    else if (!(place_off <= settings.place_limit))
      cell.unknown = "is at a place known to " + text(1e3 * place_off) + " mm only";
    start.cells[start.used[q]] = cell;
  }
  out.residual = std::sqrt(squares / std::max(1.0, count));
  out.up = fit.state.up;
  return finish();
}

/// A reconstruction without its least squares, which is the classical method: rotations from neighbour to
/// neighbour along the tree.
[[nodiscard]] inline Reconstruction procrustes_chain(const PatchGraph& patch, const RestReadings& readings,
                                                     const ReconstructionSettings& settings = {}) {
  detail::require_patch(patch, readings, settings);
  Reconstruction out;
  out.cells = detail::patch_start(patch, readings, settings).cells;
  for (const auto& c : out.cells)
    if (!c.unknown.empty()) out.unobservable.push_back({"cell " + std::to_string(c.id) + " " + c.unknown});
  return out;
}

SKINCTL_END_NAMESPACE
