// `reconstruct`: the fit, and how well it knows what it found.
#pragma once

#include <algorithm>
#include <cstdio>

#include "skinctl/calibration/detail/patch_fit.hpp"
#include "skinctl/calibration/detail/patch_start.hpp"
#include "skinctl/calibration/least_squares.hpp"
#include "skinctl/calibration/reconstruction.hpp"
#include "skinctl/calibration/sparse_inverse.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// How the poses of a fit scatter once the patch as a whole is aligned. Cells that are not known have no part in the alignment.
inline void aligned_covariances(const PatchFit& fit, const SparseNormal& normal,
                                std::vector<ReconstructedCell>& cells, const ReconstructionSettings& s) {
  const SparseNormal::Matrix H = normal.information();
  const SparseInverse C(H);
  const SparseNormal::Solver solver(H);
  const std::size_t n = cells.size();
  using Matrix = Eigen::MatrixXd;
  const auto motion = [&](std::size_t i) {  // of a cell when the patch moves: place, turn in its axes
    Matrix G = Matrix::Identity(6, 6);
    const Eigen::Matrix3d across = cross_matrix(cells[i].p);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) G(r, 3 + c) = -across(r, c), G(3 + r, 3 + c) = cells[i].R(c, r);
    return G;
  };
  const double place = 1 / (3e-4 * 3e-4), angle = 1 / (0.0174 * 0.0174);
  std::vector<bool> out(n, false);
  for (int round = 0; round < 6; ++round) {
    Matrix A = Matrix::Zero(6, 6), right = Matrix::Zero(H.rows(), 6);
    for (std::size_t i = 0; i < n; ++i) {
      if (out[i]) continue;
      const Matrix G = motion(i);
      Matrix WG = G;
      for (int r = 0; r < 6; ++r) WG.row(r) *= r < 3 ? place : angle;
      A += G.transpose() * WG;
      if (const int at = fit.pose_column(i); at >= 0) right.middleRows(at, 6) = WG;
    }
    const Matrix aligned = right * solve_symmetric(A, Matrix::Identity(6, 6));  // the alignment is aligned' e
    const Matrix with = solver.solve(aligned);
    const Matrix own = aligned.transpose() * with;
    std::vector<double> score(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Matrix G = motion(i), G_own = G * own;
      Matrix cov = G_own * G.transpose();
      if (const int at = fit.pose_column(i); at >= 0) {
        const Matrix part = with.middleRows(at, 6), cross = part * G.transpose(),
                     block = C.block(at, 6, at, 6);
        for (int c = 0; c < 6; ++c)
          for (int r = 0; r < 6; ++r) cov(r, c) += block(r, c) - cross(r, c) - cross(c, r);
      }
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) cells[i].covariance(r, c) = 0.5 * (cov(r, c) + cov(c, r));
      score[i] =
          std::max(cells[i].place_deviation() / s.place_limit, cells[i].turn_deviation() / s.turn_limit);
    }
    auto sorted = score;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(n / 2), sorted.end());
    const double limit = std::max(1.0, 1.5 * sorted[n / 2]);
    bool more = false;
    for (std::size_t i = 0; i < n; ++i)
      if (!out[i] && !(score[i] <= limit)) out[i] = more = true;
    if (!more) break;
  }
}

}  // namespace detail

inline Reconstruction procrustes_chain(const PatchGraph& patch, const RestReadings& readings,
                                       const ReconstructionSettings& s) {
  detail::require_patch(patch, readings, s);
  Reconstruction out;
  out.cells = detail::patch_start(patch, readings, s).cells;
  for (const auto& c : out.cells)
    if (!c.unknown.empty()) out.unobservable.push_back({"cell " + std::to_string(c.id) + " " + c.unknown});
  return out;
}

inline Reconstruction reconstruct(const PatchGraph& patch, const RestReadings& readings,
                                  const ReconstructionSettings& s) {
  detail::require_patch(patch, readings, s);
  auto start = detail::patch_start(patch, readings, s);
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
  const detail::PatchFit problem{start.joints, used, s, turns};
  auto fit = least_squares<SparseNormal>(problem, {std::move(cells), std::move(up)}, {.steps = 60});
  out.end = fit.end;
  out.steps = fit.steps;
  if (fit.end == FitEnd::not_finite) {
    for (const std::size_t i : start.used) start.cells[i].unknown = "has readings that are no numbers";
    return finish();
  }
  detail::aligned_covariances(problem, fit.normal, fit.state.cells, s);
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
    if (std::sqrt(own / readings_of_it) > 8 * s.reading)
      cell.unknown = "has readings that contradict its neighbours by " +
                     text(1e3 * std::sqrt(own / readings_of_it)) + " mg";
    else if (!(turn_off <= s.turn_limit))
      cell.unknown =
          "is turned by an unknown angle: to " + text(std::min(180.0, turn_off / 0.0174532925)) + " deg only";
    else if (!(place_off <= s.place_limit))
      cell.unknown = "is at a place known to " + text(1e3 * place_off) + " mm only";
    start.cells[start.used[q]] = cell;
  }
  out.residual = std::sqrt(squares / std::max(1.0, count));
  out.up = fit.state.up;
  return finish();
}

SKINCTL_END_NAMESPACE
