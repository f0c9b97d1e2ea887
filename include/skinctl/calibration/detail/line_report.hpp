// SPDX-License-Identifier: BSD-3-Clause
// The result of a fit of lines: covariances without the gauge, and what is not observed, by name.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/line_start.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// Covariances of a fit: those of white residuals and of the jackknife together, with shifts of the base and
/// its turn about the vertical projected out, such that the cells of `anchors` do not move as a whole.
class LineCovariance {
 public:
  LineCovariance(const CellFit<LineMotion>& fit, const CellSolver& solver)
      : fit_(fit),
        n_(fit.globals()),
        solver_(solver),
        motion_(solver.motion_covariance()),
        shifts_(fit.jackknife(solver)) {
    N_ = Eigen::MatrixXd::Zero(n_ + cell_unknowns * Eigen::Index(fit.cells.size()), 4);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d t = k < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k)) : Eigen::Vector3d::Zero();
      const double psi = k == 3 ? 1 : 0;
      N_.col(k).head(fit.motion.unknowns()) = fit.motion.gauge(t, psi);
      for (std::size_t m = 0; m < fit.patches.size(); ++m) {
        auto part = N_.col(k).segment<6>(fit.motion.unknowns() + 6 * Eigen::Index(m));
        part.head<3>() = psi * up;
        part.tail<3>() = t + psi * up.cross(fit.patches[m].p);
      }
      for (std::size_t c = 0; c < fit.cells.size(); ++c) {
        auto part = N_.col(k).segment<cell_unknowns>(n_ + cell_unknowns * Eigen::Index(c));
        part.head<3>() = psi * (fit.cells[c].Q.transpose() * up);
        part.segment<3>(3) = t + psi * up.cross(fit.cells[c].p);
      }
    }
    std::vector<bool> last(fit.cells.size());
    int top = 0;
    for (const auto& cell : fit.cells) top = std::max(top, cell.body);
    for (std::size_t c = 0; c < last.size(); ++c) last[c] = fit.cells[c].body == top;
    anchor(last);
  }

  void anchor(const std::vector<bool>& cells) {
    K_ = Eigen::MatrixXd::Zero(4, N_.rows());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (!cells[c]) continue;
      const Eigen::Index at = n_ + cell_unknowns * Eigen::Index(c) + 3;
      for (Eigen::Index i = at; i < at + 3; ++i)
        for (Eigen::Index k = 0; k < 4; ++k) K_(k, i) = N_(i, k);
    }
    Eigen::MatrixXd A = K_ * N_;
    for (Eigen::Index k = 0; k < 4; ++k) A(k, k) += 1e-12;
    K_ = solve_symmetric(A, K_);
    U_.resize(N_.rows(), 4);
    std::vector<CellVector> cell_g(fit_.cells.size());
    for (int k = 0; k < 4; ++k) {
      const Eigen::VectorXd gauge = K_.row(k);
      Eigen::VectorXd g = gauge.head(n_);
      for (std::size_t c = 0; c < cell_g.size(); ++c)
        cell_g[c] = gauge.segment<cell_unknowns>(n_ + cell_unknowns * Eigen::Index(c));
      solver_.solve(g, cell_g);
      auto column = U_.col(k);
      column.head(n_) = g;
      for (std::size_t c = 0; c < cell_g.size(); ++c)
        column.segment<cell_unknowns>(n_ + cell_unknowns * Eigen::Index(c)) = cell_g[c];
    }
    KU_ = K_ * U_;
    const Eigen::MatrixXd common = K_ * shifts_;
    projected_ = shifts_ - N_ * common;
  }

  [[nodiscard]] Eigen::MatrixXd cell(std::size_t c) const {
    const Eigen::Index at = n_ + cell_unknowns * Eigen::Index(c);
    return with_gauge_out(solver_.cell_covariance(c, motion_), at, cell_unknowns);
  }
  [[nodiscard]] Eigen::MatrixXd line(std::size_t j) const {
    const Eigen::Index at = 4 * Eigen::Index(j);
    return with_gauge_out(motion_.block(at, at, 4, 4), at, 4);
  }
  [[nodiscard]] double lateness() const { return deviation(fit_.motion.unknowns() - 1); }
  [[nodiscard]] double compliance(std::size_t j) const {
    return deviation(4 * Eigen::Index(fit_.motion.lines.size()) + Eigen::Index(j));
  }
  [[nodiscard]] double deviation(Eigen::Index at) const {
    return std::sqrt(motion_(at, at) + shifts_.row(at).squaredNorm());
  }

 private:
  [[nodiscard]] Eigen::MatrixXd with_gauge_out(const Eigen::MatrixXd& own, Eigen::Index at,
                                               Eigen::Index size) const {
    const Eigen::MatrixXd N = N_.middleRows(at, size), U = U_.middleRows(at, size),
                          D = projected_.middleRows(at, size), NU = N * U.transpose(), N_KU = N * KU_;
    Eigen::MatrixXd out = own;
    out.noalias() += N_KU * N.transpose();
    out.noalias() += D * D.transpose();
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j) out(i, j) -= NU(i, j) + NU(j, i);
    return out;
  }

  const CellFit<LineMotion>& fit_;
  Eigen::Index n_;
  const CellSolver& solver_;
  Eigen::MatrixXd motion_, shifts_, N_, K_, U_, KU_, projected_;
};

inline double largest(const Eigen::MatrixXd& covariance) {
  return std::sqrt(std::max(0.0, SymmetricEigen(covariance).largest()));
}
inline std::string words(const Eigen::Vector3d& v) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f %.2f %.2f)", v.x(), v.y(), v.z());
  return text;
}

/// Names the motions of a link's cells that are known worse than the limits: in coordinates of its joint's
/// axis.
inline void name_unobserved(const JointLines& in, int joint, const JointLinesSettings& s,
                            std::vector<Unobservable>& out) {
  const AxisLine& axis = in.lines[std::size_t(joint)].line;
  const Eigen::Vector3d z = axis.direction, x = z.unitOrthogonal(), y = z.cross(x);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(6, 6);
  double count = 0;
  for (const CalibratedCell& cell : in.cells) {
    if (cell.joint != joint || cell.known) continue;
    Eigen::MatrixXd to_axis = Eigen::MatrixXd::Identity(6, 6);  // dp of the axis' point
    const Eigen::Vector3d off = cell.p - axis.point;
    const Eigen::Matrix3d turned = cross_matrix(off) * cell.R;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) to_axis(i, 3 + j) = turned(i, j), to_axis(3 + i, 3 + j) = cell.R(i, j);
    const Eigen::MatrixXd own = cell.covariance, moved = to_axis * own;
    mean.noalias() += moved * to_axis.transpose();
    count += 1;
  }
  if (count == 0) return;
  mean /= count;
  const std::string link = "link " + std::to_string(joint) + ": ";
  const bool upright = std::abs(z.z()) > 0.9962;
  const auto name = [&](const Eigen::Vector3d& d, bool turn, const std::string& what,
                        const std::string& remedy) {
    const int at = turn ? 3 : 0;
    double v = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) v += d(i) * mean(at + i, at + j) * d(j);
    const double deviation = std::sqrt(std::max(0.0, v));
    if (deviation > (turn ? s.known_turn : s.known_position))
      out.push_back({link + what, deviation, turn ? "rad" : "m", remedy});
  };
  const std::string tilt =
      upright ? "tilt the base by 5 degrees, or see its patch with a camera" : "move more joints";
  name(z, false, upright ? "height of its cells" : "place of its cells along the joint's axis",
       upright ? "see its patch with a camera" : "move more joints");
  name(z, true, "turn of its cells about the joint's axis (azimuth)", tilt);
  name(x, false, "place of its cells along " + words(x), tilt);
  name(y, false, "place of its cells along " + words(y), tilt);
  name(x, true, "tilt of its cells about " + words(x), tilt);
  name(y, true, "tilt of its cells about " + words(y), tilt);
}

inline void report_lines(const CellFit<LineMotion>& fit, const LineStart& start, const JointLinesSettings& s,
                         bool torque, JointLines& out) {
  const CellEquations e = fit.equations();
  CellSolver solver;
  if (!solver.factorise(e, 0)) refuse("skinctl: the fit of the joints' lines is singular");
  LineCovariance covariance(fit, solver);
  out.steps = fit.steps, out.converged = fit.converged;
  const auto pose = [&](std::size_t k) {
    // Position first, then the turn.
    const Eigen::MatrixXd C = covariance.cell(k);
    Eigen::Matrix<double, 6, 6> P;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) P(i, j) = C((i + 3) % 6, (j + 3) % 6);
    // Cross-axis sensitivity that is not symmetric is a turn of the sensor: no residual shows it.
    for (int i = 3; i < 6; ++i) P(i, i) += 0.5 * s.cross_axis * s.cross_axis;
    return P;
  };
  std::vector<bool> known(fit.cells.size());
  const auto judge = [&] {
    for (std::size_t k = 0; k < known.size(); ++k) {
      const auto P = pose(k);
      known[k] = largest(P.topLeftCorner<3, 3>()) <= s.known_position &&
                 largest(P.bottomRightCorner<3, 3>()) <= s.known_turn;
    }
  };
  judge();
  if (std::count(known.begin(), known.end(), true) > 0) {
    covariance.anchor(known);
    judge();
  }
  out.cells.assign(start.reason.size(), {});
  out.lines.assign(out.activation.moved_alone.size(), {});
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < fit.cells.size(); ++k) {
    const FittedCell& cell = fit.cells[k];
    const std::size_t c = start.used[k];
    CalibratedCell& placed = out.cells[c];
    placed.joint = start.joints[std::size_t(cell.body)];
    placed.R = cell.Q, placed.p = cell.p, placed.bias = cell.b, placed.scale = cell.s;
    placed.covariance = pose(k);
    placed.known = known[k];
    placed.residual = cell.deviation;
    if (!known[k]) {
      char text[160];
      std::snprintf(text, sizeof text, "its pose is known to %.3g m and %.3g rad only",
                    largest(placed.covariance.topLeftCorner<3, 3>()),
                    largest(placed.covariance.bottomRightCorner<3, 3>()));
      placed.reason = text;
    }
    if (!start.reason[c].empty()) {
      placed.known = known[k] = false;
      continue;
    }
    squares += e.squares[k], count += 3 * double(fit.data().present(Eigen::Index(k)));
  }
  for (std::size_t c = 0; c < start.reason.size(); ++c)
    if (!start.reason[c].empty()) out.cells[c].reason = start.reason[c];
  out.residual = std::sqrt(squares / std::max(count, 1.0));
  out.lateness = {fit.motion.lateness, covariance.lateness()};
  for (std::size_t k = 0; k < start.joints.size(); ++k) {
    CalibratedLine& line = out.lines[std::size_t(start.joints[k])];
    line.line = fit.motion.lines[k];
    const Eigen::MatrixXd C = covariance.line(k);
    if (torque) line.compliance = {fit.motion.compliance[k], covariance.compliance(k)};
    line.direction_deviation = largest(C.topLeftCorner(2, 2));
    line.position_deviation = largest(C.bottomRightCorner(2, 2));
    line.known = line.direction_deviation <= s.known_turn && line.position_deviation <= s.known_position;
  }
  // No residual shows it: the same motion errs in the same way each time.
  if (!torque)
    out.unobservable.push_back({"compliance of the joints, which no covariance holds then",
                                std::numeric_limits<double>::infinity(), "rad/(N m)",
                                "record the torques at the joints' outputs"});
  for (std::size_t j = 0; j < out.lines.size(); ++j) {
    const std::string joint = "joint " + std::to_string(j) + ": ";
    const bool fitted = std::find(start.joints.begin(), start.joints.end(), int(j)) != start.joints.end();
    const double infinite = std::numeric_limits<double>::infinity();
    if (!fitted) {
      const bool moved = out.activation.moved_alone[j];
      out.unobservable.push_back(
          {joint + "its axis", infinite, "",
           moved ? "it moves no cell: put a cell behind it" : "it did not move: move it alone, from home"});
      continue;
    }
    const CalibratedLine& line = out.lines[j];
    if (line.direction_deviation > s.known_turn)
      out.unobservable.push_back(
          {joint + "direction of its axis", line.direction_deviation, "rad", "move it further"});
    if (line.position_deviation > s.known_position)
      out.unobservable.push_back(
          {joint + "place of its axis", line.position_deviation, "m", "move it faster, or more joints"});
    name_unobserved(out, int(j), s, out.unobservable);
  }
}

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
