// SPDX-License-Identifier: BSD-3-Clause
// The start of the fit of lines: each joint's line as cells of the last link see it, upright; others match
// these lines.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/joint_lines_types.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// Refuses a joint that moves but is never seen alone: it would be taken for an error of the others.
inline void refuse_hidden_motion(const MeasuredMotion& motion, const Activation& activation) {
  JointPoint p;
  Eigen::VectorXd low = activation.home, high = activation.home;
  for (double t = motion.start(); t < motion.end(); t += 0.05) {
    motion.at(t, p);
    low = low.cwiseMin(p.q), high = high.cwiseMax(p.q);
  }
  for (int j = 0; j < motion.joints(); ++j) {
    if (activation.moved_alone[std::size_t(j)] || high(j) - low(j) < 0.02) continue;
    refuse(
        "skinctl: joint " + std::to_string(j) + " moves by " + std::to_string(high(j) - low(j)) +
        " rad, but never alone for a second, with all others at home: which cells it carries cannot be told");
  }
}

/// Cells that are rigid to each other: of one patch, or a single one.
struct CellGroup {
  std::vector<std::size_t> cells;
  int patch = -1;
  int joint = -1;  ///< last joint that moves the group
  struct Line {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ(),
                    point = Eigen::Vector3d::Zero();  ///< line in the group's axes
    double certainty = 0;
  };
  std::vector<Line> lines;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< axes of the group in the base
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

inline CellInPatch place_of(const std::vector<CellInPatch>& places, std::size_t cell) {
  return places.empty() || places[cell].patch < 0 ? CellInPatch{} : places[cell];
}

inline void sum_up(CellGroup& group, const Activation& activation, const std::vector<CellInPatch>& places) {
  const std::size_t joints = activation.moved_alone.size();
  // The link of most of its cells.
  std::vector<int> votes(joints + 1, 0);
  for (const std::size_t c : group.cells) ++votes[std::size_t(activation.link(c) + 1)];
  group.joint = int(std::max_element(votes.begin(), votes.end()) - votes.begin()) - 1;
  group.lines.assign(joints, {});
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < joints; ++j) {
    auto& line = group.lines[j];
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(), point = axis;
    double sum = 0;
    for (const std::size_t c : group.cells) {
      const JointSignature& s = activation.cells[c][j];
      if (!s.measured) continue;
      const CellInPatch place = place_of(places, c);
      up += place.R * s.up;
      const double weight = s.certainty * s.certainty;
      axis += weight * (place.R * s.axis), point += weight * (place.p + place.R * s.to_axis), sum += weight;
    }
    if (sum > 0 && axis.norm() > 0)
      line.axis = axis.normalized(), line.point = point / sum, line.certainty = std::sqrt(sum);
  }
  if (up.norm() > 0) group.up = up.normalized();
}

/// Sets the pose in which the group's lines lie on those of the base, and its up is up; any pose where they
/// leave it open.
inline void align(CellGroup& group, const std::vector<int>& joints, const std::vector<AxisLine>& lines) {
  const double least = 1e-9;
  Eigen::Matrix3d B = 600 * Eigen::Vector3d::UnitZ() * group.up.transpose();  // an upright known to 40 mg
  for (std::size_t k = 0; k < joints.size() && joints[k] <= group.joint; ++k) {
    const auto& line = group.lines[std::size_t(joints[k])];
    B += std::min(line.certainty * line.certainty, 1e4) * lines[k].direction * line.axis.transpose();
  }
  group.R = nearest_turn(B);
  Eigen::Matrix3d A = least * Eigen::Matrix3d::Identity();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < joints.size() && joints[k] <= group.joint; ++k) {
    const Eigen::Vector3d& w = lines[k].direction;
    const Eigen::Matrix3d P = Eigen::Matrix3d::Identity() - w * w.transpose();
    A += P, b += P * (lines[k].point - group.R * group.lines[std::size_t(joints[k])].point);
  }
  group.p = solve_symmetric(A, b);
}

struct LineStart {
  std::vector<int> joints;  ///< joints that are fitted
  std::vector<AxisLine> lines;
  std::vector<FittedCell> cells;
  std::vector<std::size_t> used;  ///< number of each of `cells` in the recording
  std::vector<FittedPatch> patches;
  std::vector<std::string> reason;  ///< reason for which a cell of the recording is not used
};

[[nodiscard]] inline LineStart start_lines(const Activation& activation,
                                           const std::vector<CellInPatch>& places, const BlockMeans& data) {
  LineStart out;
  const std::size_t count = activation.cells.size(), joints = activation.moved_alone.size();
  out.reason.resize(count);
  std::vector<CellGroup> groups;
  for (std::size_t c = 0; c < count; ++c) {
    if (double(data.present(Eigen::Index(c))) < 0.5 * double(data.blocks())) {
      out.reason[c] = "it reported in less than half of the time";
      continue;
    }
    const int patch = place_of(places, c).patch;
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const CellGroup& g) { return patch >= 0 && g.patch == patch; });
    if (group == groups.end()) group = groups.insert(groups.end(), CellGroup{}), group->patch = patch;
    group->cells.push_back(c);
  }
  for (auto& group : groups) sum_up(group, activation, places);
  // Joints that move somebody, up to the last link with cells.
  CellGroup* reference = nullptr;
  for (std::size_t j = 0; j < joints; ++j) {
    bool moves = false;
    for (const auto& group : groups)
      for (const std::size_t c : group.cells)
        moves = moves || (group.joint >= int(j) && activation.cells[c][j].moves);
    if (moves && activation.moved_alone[j]) out.joints.push_back(int(j));
  }
  const auto least = [&](const CellGroup& g) {
    double worst = 1e300;
    for (const int j : out.joints)
      if (j <= g.joint) worst = std::min(worst, g.lines[std::size_t(j)].certainty);
    return worst;
  };
  for (auto& group : groups) {
    if (group.joint < 0) {
      for (const std::size_t c : group.cells) out.reason[c] = "no joint moves it";
      continue;
    }
    if (reference == nullptr || group.joint > reference->joint ||
        (group.joint == reference->joint && least(group) > least(*reference)))
      reference = &group;
  }
  if (reference == nullptr) return out;
  const Eigen::Vector3d across = reference->up.cross(Eigen::Vector3d::UnitZ());
  const double sine = across.norm(), angle = std::atan2(sine, reference->up.z());
  const Eigen::Matrix3d upright =
      turn(sine > 1e-9 ? Eigen::Vector3d(across * (angle / sine)) : Eigen::Vector3d(angle, 0, 0));
  for (const int j : out.joints) {
    const auto& line = reference->lines[std::size_t(j)];
    out.lines.push_back({(upright * line.axis).normalized(), upright * line.point});
  }
  for (auto& group : groups) {
    if (group.joint < 0) continue;
    align(group, out.joints, out.lines);
    int body = 0;
    for (std::size_t k = 0; k < out.joints.size(); ++k)
      if (out.joints[k] <= group.joint) body = int(k);
    const int patch = group.cells.size() > 1 ? int(out.patches.size()) : -1;
    if (patch >= 0) out.patches.push_back({group.R, group.p});
    for (const std::size_t c : group.cells) {
      const CellInPatch place = place_of(places, c);
      FittedCell cell;
      cell.R_PC = place.R, cell.p_PC = place.p;
      cell.Q = group.R * place.R, cell.p = group.p + group.R * place.p;
      cell.body = body, cell.patch = patch;
      out.cells.push_back(cell);
      out.used.push_back(c);
    }
  }
  return out;
}

[[nodiscard]] inline BlockMeans only_cells(const BlockMeans& data, const std::vector<std::size_t>& cells) {
  BlockMeans out;
  out.start = data.start, out.length = data.length;
  out.y.resize(data.blocks(), 3 * Eigen::Index(cells.size()));
  out.missing.resize(data.blocks(), Eigen::Index(cells.size()));
  for (std::size_t k = 0; k < cells.size(); ++k) {
    out.y.middleCols(3 * Eigen::Index(k), 3) = data.y.middleCols(3 * Eigen::Index(cells[k]), 3);
    out.missing.col(Eigen::Index(k)) = data.missing.col(Eigen::Index(cells[k]));
  }
  return out;
}

/// Leaves out cells that lie: residuals of four times the median do not belong to any place on the robot;
/// cells that stand apart from their patch by six deviations are not where it says.
inline void leave_out_liars(CellFit<LineMotion>& fit, BlockMeans& data, LineStart& start) {
  std::vector<double> sorted;
  for (const FittedCell& cell : fit.cells) sorted.push_back(cell.deviation);
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  for (std::size_t k = 0; k < fit.cells.size(); ++k) {
    FittedCell& cell = fit.cells[k];
    char text[120] = "";
    if (cell.deviation > 4 * usual && cell.deviation > 0.002) {
      std::snprintf(text, sizeof text, "its readings do not fit any place: %.3g mg, others %.3g",
                    cell.deviation * 1e3, usual * 1e3);
    } else if (cell.patch >= 0) {
      const FittedPatch& patch = fit.patches[std::size_t(cell.patch)];
      const double off = (cell.p - patch.p - patch.R * cell.p_PC).norm() / fit.settings.tie_position;
      const double turned_off =
          turn_vector((patch.R * cell.R_PC).transpose() * cell.Q).norm() / fit.settings.tie_turn;
      if (off > 6 || turned_off > 6)
        std::snprintf(text, sizeof text, "it is not where its patch says, by %.2g mm, %.2g rad",
                      1e3 * off * fit.settings.tie_position, turned_off * fit.settings.tie_turn);
    }
    if (text[0] == 0) continue;
    start.reason[start.used[k]] = text;
    cell.patch = -1, cell.deviation = 1;
    data.missing.col(Eigen::Index(k)).setConstant(true);
    data.y.middleCols(3 * Eigen::Index(k), 3).setZero();
  }
}

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
