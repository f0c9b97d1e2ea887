// SPDX-License-Identifier: BSD-3-Clause
// What a reconstruction starts from: rotations from neighbour to neighbour, and cells that are no use.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "skinctl/calibration/detail/nearest_turn.hpp"
#include "skinctl/calibration/reconstruction_types.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The rotation that maps readings of `b` to those of `a`, and the rms that it leaves [g].
struct PairTurn {
  Eigen::Matrix3d R_ab = Eigen::Matrix3d::Identity();
  double rest = std::numeric_limits<double>::infinity();
  int poses = 0;
};
[[nodiscard]] inline PairTurn procrustes(const std::vector<Eigen::Vector3d>& a,
                                         const std::vector<Eigen::Vector3d>& b) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  PairTurn out;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k].allFinite() && b[k].allFinite()) M += a[k] * b[k].transpose(), ++out.poses;
  if (out.poses < 3) return out;
  out.R_ab = fit::nearest_turn(M);
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k].allFinite() && b[k].allFinite()) sum += (a[k] - out.R_ab * b[k]).squaredNorm();
  out.rest = std::sqrt(sum / out.poses);
  return out;
}

SKINCTL_COLD inline void require_patch(const PatchGraph& patch, const RestReadings& readings,
                                       const ReconstructionSettings& s) {
  require(!patch.ids.empty(), "reconstruction: cells", 0, ">= 1");
  require(readings.size() == patch.ids.size(), "reconstruction: cells with readings", double(readings.size()),
          "as many as the patch has");
  const std::size_t poses = readings.front().size();
  require(poses >= 3 && poses <= 1000, "reconstruction: poses", double(poses), "3 to 1000");
  for (const auto& y : readings)
    require(y.size() == poses, "reconstruction: poses of a cell", double(y.size()), "as of the first");
  require(s.reading > 0 && s.reading < 1, "reconstruction: reading", s.reading, "0 to 1 g");
  require(s.gap > 0 && s.gap < 0.1, "reconstruction: gap", s.gap, "0 to 0.1 m");
  require(s.prior.bias > 0 && s.prior.scale > 0 && s.prior.misalignment > 0, "reconstruction: prior", 0,
          "> 0");
  for (const auto& j : patch.joints)
    require(j.a < patch.ids.size() && j.b < patch.ids.size() && j.port_a < 4 && j.port_b < 4,
            "reconstruction: connector of cell", double(j.a), "between ports of its cells");
}

/// What a fit starts from: cells that are no use are marked, and the largest piece without them is laid out.
struct PatchStart {
  std::vector<ReconstructedCell> cells;
  std::vector<std::size_t> used;          // indices of the cells of the piece, its root first
  std::vector<PatchGraph::Joint> joints;  // between these, by their place in `used`
};
[[nodiscard]] inline PatchStart patch_start(const PatchGraph& patch, const RestReadings& readings,
                                            const ReconstructionSettings& s) {
  PatchStart out;
  const std::size_t n = patch.ids.size();
  std::vector<bool> usable(n, true);
  for (std::size_t i = 0; i < n; ++i) {
    auto& cell = out.cells.emplace_back();
    cell.id = patch.ids[i];
    int poses = 0;
    double worst = 0;
    for (const auto& y : readings[i])
      if (y.allFinite()) ++poses, worst = std::max(worst, std::abs(y.norm() - 1));
    if (poses < 3)
      cell.unknown = "was recorded in " + std::to_string(poses) + " poses: three are needed";
    else if (worst > 0.2)
      cell.unknown = "reads up to " + std::to_string(1 + worst).substr(0, 4) +
                     " g off or on 1 g: it was not at rest, or its accelerometer is broken";
    usable[i] = cell.unknown.empty();
  }
  // Two cells on one body turn alike, to within what the errors of their sensors explain.
  const double alike = 5 * std::sqrt(2.0) * s.prior.bias + 4 * s.prior.scale + 4 * s.reading;
  std::vector<PairTurn> pair(patch.joints.size());
  std::vector<std::vector<std::size_t>> at(n);
  for (std::size_t j = 0; j < patch.joints.size(); ++j) {
    const auto& joint = patch.joints[j];
    if (!usable[joint.a] || !usable[joint.b]) continue;
    pair[j] = procrustes(readings[joint.a], readings[joint.b]);
    if (pair[j].rest < alike) at[joint.a].push_back(j), at[joint.b].push_back(j);
  }
  std::vector<bool> seen(n, false);
  for (std::size_t root = 0; root < n; ++root) {
    if (!usable[root] || seen[root]) continue;
    std::vector<std::size_t> piece = {root};
    seen[root] = true;
    out.cells[root].R.setIdentity(), out.cells[root].p.setZero();
    for (std::size_t q = 0; q < piece.size(); ++q)
      for (const std::size_t j : at[piece[q]]) {
        const auto& joint = patch.joints[j];
        const bool forward = joint.a == piece[q];
        const std::size_t from = piece[q], to = forward ? joint.b : joint.a;
        if (seen[to]) continue;
        seen[to] = true;
        piece.push_back(to);
        auto &c = out.cells[to], &base = out.cells[from];
        c.R = base.R * (forward ? pair[j].R_ab : Eigen::Matrix3d(pair[j].R_ab.transpose()));
        c.p = base.p + base.R * s.ports[forward ? joint.port_a : joint.port_b] -
              c.R * s.ports[forward ? joint.port_b : joint.port_a];
      }
    if (piece.size() > out.used.size()) out.used.swap(piece);
  }
  std::vector<std::size_t> place(n, n);
  for (std::size_t q = 0; q < out.used.size(); ++q) place[out.used[q]] = q;
  for (std::size_t j = 0; j < patch.joints.size(); ++j) {
    const auto& joint = patch.joints[j];
    if (place[joint.a] < n && place[joint.b] < n && pair[j].rest < alike)
      out.joints.push_back({place[joint.a], place[joint.b], joint.port_a, joint.port_b});
  }
  for (std::size_t i = 0; i < n; ++i)
    if (usable[i] && place[i] == n)
      out.cells[i].unknown =
          n == 1 ? "" : "does not turn with its neighbours: it lies, or a cable joins it to another link";
  return out;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
