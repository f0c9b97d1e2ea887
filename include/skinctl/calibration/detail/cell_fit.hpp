// Poses of accelerometers on bodies whose motion depends on a few unknowns: the least squares of `joint_lines.hpp`.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/calibration/detail/cell_equations.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// @tparam Motion  `int unknowns()`, `void hold(VectorXd& information, VectorXd& gradient)` for its priors, `Motion moved(VectorXd)`, `std::vector<BodySignals> signals(const BlockMeans&)`.
template <class Motion>
class CellFit {
 public:
  Motion motion;
  std::vector<FittedCell> cells;
  std::vector<FittedPatch> patches;
  CellFitSettings settings;
  int steps = 0;
  bool converged = false;

  CellFit(const BlockMeans& data, Motion m, std::vector<FittedCell> c, std::vector<FittedPatch> p,
          const CellFitSettings& s)
      : motion(std::move(m)), cells(std::move(c)), patches(std::move(p)), settings(s), data_(data) {
    signals_ = motion.signals(data_);
  }

  /// From the present state on; Levenberg and Marquardt.
  void run() {
    double damping = 1e-4;
    CellEquations now = equations();
    converged = false;
    for (int refused = 0; steps < settings.steps && refused < 12; ++steps) {
      CellSolver solver;
      if (!solver.factorise(now, damping)) {
        damping *= 10, ++refused;
        continue;
      }
      Eigen::VectorXd g = now.g;
      std::vector<Cell12> cell_g = now.cell_g;
      solver.solve(g, cell_g);
      const CellFit before = *this;
      move(g, cell_g);
      CellEquations next = equations();
      if (next.cost < now.cost) {
        const double gain = now.cost - next.cost;
        now = std::move(next);
        damping = std::max(1e-9, damping / 10);
        refused = 0;
        if (gain < settings.decrease || gain < 1e-9 * now.cost) {
          converged = true;
          break;
        }
      } else {
        converged = next.cost < now.cost * (1 + 1e-9);
        const int done = steps;
        *this = before;
        steps = done;
        if (converged) break;
        damping = std::max(1e-6, damping) * 10, ++refused;
      }
    }
  }

  /// Sets each cell's deviation from its residuals.
  void weigh() {
    const CellEquations e = equations();
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const double count = 3 * double(data_.present(Eigen::Index(c)));
      if (count > 12) cells[c].deviation = std::sqrt(std::max(e.squares[c], 1e-12 * count) / (count - 10));
    }
  }

  [[nodiscard]] CellEquations equations() const;
  /// Residuals of all blocks [g], three columns per cell; 0 where missing.
  [[nodiscard]] Eigen::MatrixXd residuals() const {
    Eigen::MatrixXd r = data_.y;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const CellWeights w(cells[c]);
      const auto& phi = signals_[std::size_t(cells[c].body)].columns;
      for (int k = 0; k < 3; ++k) {
        auto column = r.col(3 * Eigen::Index(c) + k);
        column.noalias() -= phi.template leftCols<13>() * w.c[k];
        column.array() *= 1 - data_.missing.col(Eigen::Index(c)).template cast<double>();
      }
    }
    return r;
  }
  /// The changes of all unknowns that the residuals of single windows of time ask for, as columns: motion and patches,
  /// then cells. The sum of their squares is the covariance that does not take residuals for white.
  [[nodiscard]] Eigen::MatrixXd jackknife(const CellSolver& solver) const;
  [[nodiscard]] const std::vector<BodySignals>& signals() const noexcept { return signals_; }
  [[nodiscard]] const BlockMeans& data() const noexcept { return data_; }
  [[nodiscard]] Eigen::Index globals() const noexcept {
    return motion.unknowns() + 6 * Eigen::Index(patches.size());
  }

 private:
  void move(const Eigen::VectorXd& g, const std::vector<Cell12>& cell_g) {
    motion = motion.moved(g.head(motion.unknowns()));
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const Eigen::Matrix<double, 6, 1> d = g.segment<6>(motion.unknowns() + 6 * Eigen::Index(k));
      patches[k].R = straightened(turn(d.head<3>()) * patches[k].R);
      patches[k].p += d.tail<3>();
    }
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = cells[c].moved(cell_g[c]);
    signals_ = motion.signals(data_);
  }
  void tie(std::size_t c, CellEquations& e) const;

  const BlockMeans& data_;
  std::vector<BodySignals> signals_;

 public:
  CellFit(const CellFit&) = default;
  CellFit& operator=(const CellFit& o) {
    motion = o.motion, cells = o.cells, patches = o.patches, settings = o.settings, steps = o.steps;
    converged = o.converged, signals_ = o.signals_;
    return *this;
  }
};

template <class Motion>
CellEquations CellFit<Motion>::equations() const {
  using Index = Eigen::Index;
  const Index n = globals();
  CellEquations e;
  e.H = Eigen::MatrixXd::Zero(n, n), e.g = Eigen::VectorXd::Zero(n);
  e.cell_H.assign(cells.size(), Eigen::Matrix<double, 12, 12>::Zero());
  e.cell_g.assign(cells.size(), Cell12::Zero());
  e.cross.assign(cells.size(), Eigen::MatrixXd::Zero(n, 12));
  e.squares.assign(cells.size(), 0);
  Eigen::MatrixXd gram, own_gram, Y, X;
  std::vector<Index> members, lost;
  for (std::size_t body = 0; body < signals_.size(); ++body) {
    const BodySignals& signal = signals_[body];
    members.clear();
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (std::size_t(cells[c].body) == body) members.push_back(Index(c));
    if (members.empty()) continue;
    const Eigen::MatrixXd& phi = signal.columns;
    const Index width = phi.cols(), unknowns = Index(signal.unknowns.size());
    gram = Eigen::MatrixXd::Zero(width, width);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
    gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
    Y.resize(phi.rows(), 3 * Index(members.size()));
    for (std::size_t m = 0; m < members.size(); ++m)
      Y.middleCols<3>(3 * Index(m)) = data_.y.middleCols<3>(3 * members[m]);
    X.noalias() = phi.transpose() * Y;
    for (std::size_t m = 0; m < members.size(); ++m) {
      const auto c = std::size_t(members[m]);
      lost.clear();
      for (Index k = 0; k < data_.blocks(); ++k)
        if (data_.missing(k, Index(c))) lost.push_back(k);
      const Eigen::MatrixXd* G = &gram;
      if (!lost.empty()) {
        Eigen::MatrixXd rows(Index(lost.size()), width);
        for (std::size_t k = 0; k < lost.size(); ++k) rows.row(Index(k)) = phi.row(lost[k]);
        own_gram = gram;
        own_gram.noalias() -= rows.transpose() * rows;
        G = &own_gram;
      }
      const CellWeights w(cells[c]);
      const double weight = 1 / (cells[c].deviation * cells[c].deviation);
      auto& cross = e.cross[c];
      const auto G00 = G->topLeftCorner<13, 13>();
      Eigen::MatrixXd T(unknowns, width);
      for (int k = 0; k < 3; ++k) {
        const auto& v = w.c[k];
        const Eigen::Matrix<double, 12, 1> v12 = v.head<12>();
        const Eigen::VectorXd x = X.col(3 * Index(m) + k);
        const Eigen::Matrix<double, 13, 1> rest = x.head<13>() - G00 * v;
        e.squares[c] += Y.col(3 * Index(m) + k).squaredNorm() - v.dot(x.head<13>()) - v.dot(rest);
        e.cell_g[c].noalias() += weight * w.by_cell[k].transpose() * rest;
        e.cell_H[c].noalias() += weight * w.by_cell[k].transpose() * G00 * w.by_cell[k];
        for (Index i = 0; i < unknowns; ++i)
          T.row(i).noalias() = v12.transpose() * G->middleRows<12>(13 + 12 * i);
        for (Index i = 0; i < unknowns; ++i) {
          const Index row = signal.unknowns[std::size_t(i)];
          e.g(row) += weight * (v12.dot(x.segment<12>(13 + 12 * i)) - T.row(i).head<13>().dot(v));
          cross.row(row).noalias() += weight * T.row(i).head<13>() * w.by_cell[k];
          for (Index j = 0; j <= i; ++j) {
            const double h = weight * T.row(i).segment<12>(13 + 12 * j).dot(v12);
            const Index column = signal.unknowns[std::size_t(j)];
            e.H(row, column) += h;
            if (i != j) e.H(column, row) += h;
          }
        }
      }
      e.cost += 0.5 * weight * e.squares[c];
    }
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const double bias = 1 / (settings.bias * settings.bias), scale = 1 / (settings.scale * settings.scale);
    const double place = 1 / (settings.weak_position * settings.weak_position);
    const double angle = 1 / (settings.weak_turn * settings.weak_turn);
    e.cost += 0.5 * (bias * cells[c].b.squaredNorm() + scale * cells[c].s.squaredNorm());
    e.cell_g[c].segment<3>(6) -= bias * cells[c].b;
    e.cell_g[c].tail<3>() -= scale * cells[c].s;
    e.cell_H[c].diagonal().head<3>().array() += angle;
    e.cell_H[c].diagonal().segment<3>(3).array() += place;
    e.cell_H[c].diagonal().segment<3>(6).array() += bias;
    e.cell_H[c].diagonal().tail<3>().array() += scale;
    if (cells[c].patch >= 0) tie(c, e);
  }
  const Index own = motion.unknowns();
  e.H.diagonal().head(own).array() += 1 / (settings.weak_position * settings.weak_position);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(own), gradient = diagonal;
  motion.hold(diagonal, gradient);
  e.H.diagonal().head(own) += diagonal;
  e.g.head(own) += gradient;
  e.cost += 0.5 * (gradient.array().square() / diagonal.array().max(1e-300)).sum();
  for (std::size_t k = 0; k < patches.size(); ++k)
    e.H.diagonal().segment<6>(own + 6 * Index(k)).array() += 1e-6;
  return e;
}

template <class Motion>
void CellFit<Motion>::tie(std::size_t c, CellEquations& e) const {
  const FittedCell& cell = cells[c];
  const FittedPatch& patch = patches[std::size_t(cell.patch)];
  const Eigen::Index at = motion.unknowns() + 6 * cell.patch;
  const double wp = 1 / (settings.tie_position * settings.tie_position),
               wt = 1 / (settings.tie_turn * settings.tie_turn);
  const Eigen::Vector3d arm = patch.R * cell.p_PC;
  const Eigen::Vector3d rp = cell.p - patch.p - arm;
  const Eigen::Matrix3d R = patch.R * cell.R_PC;
  const Eigen::Vector3d rt = turn_vector(R.transpose() * cell.Q);
  Eigen::Matrix<double, 6, 6> by_cell = Eigen::Matrix<double, 6, 6>::Zero(), by_patch = by_cell;
  by_cell.topLeftCorner<3, 3>().setIdentity();  // turns: small
  by_cell.bottomRightCorner<3, 3>().setIdentity();
  by_patch.topLeftCorner<3, 3>() = -cell.Q.transpose();
  by_patch.bottomLeftCorner<3, 3>() = cross_matrix(arm);
  by_patch.bottomRightCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 6, 1> r, w;
  r << rt, rp;
  w << wt, wt, wt, wp, wp, wp;
  e.cost += 0.5 * r.dot(w.cwiseProduct(r));
  e.cell_H[c].topLeftCorner<6, 6>() += by_cell.transpose() * w.asDiagonal() * by_cell;
  e.cell_g[c].head<6>() -= by_cell.transpose() * w.cwiseProduct(r);
  e.H.block<6, 6>(at, at) += by_patch.transpose() * w.asDiagonal() * by_patch;
  e.g.segment<6>(at) -= by_patch.transpose() * w.cwiseProduct(r);
  e.cross[c].block<6, 6>(at, 0) += by_patch.transpose() * w.asDiagonal() * by_cell;
}

template <class Motion>
Eigen::MatrixXd CellFit<Motion>::jackknife(const CellSolver& solver) const {
  using Index = Eigen::Index;
  const Eigen::MatrixXd r = residuals();
  const auto rows = std::max<Index>(1, Index(std::lround(settings.window / data_.length)));
  const Index windows = std::max<Index>(1, data_.blocks() / rows), n = globals();
  Eigen::MatrixXd out(n + 12 * Index(cells.size()), windows);
  Eigen::MatrixXd X;
  Eigen::VectorXd g;
  std::vector<Cell12> cell_g(cells.size());
  std::vector<CellWeights> weights;
  for (const FittedCell& cell : cells) weights.emplace_back(cell);
  for (Index window = 0; window < windows; ++window) {
    const Index first = window * rows, count = window + 1 == windows ? data_.blocks() - first : rows;
    g = Eigen::VectorXd::Zero(n);
    std::vector<Index> at(signals_.size(), 0);
    std::vector<Eigen::MatrixXd> body_r(signals_.size());
    for (std::size_t body = 0; body < signals_.size(); ++body) {
      Index members = 0;
      for (const FittedCell& cell : cells) members += std::size_t(cell.body) == body;
      Eigen::MatrixXd part(count, 3 * members);
      Index m = 0;
      for (std::size_t c = 0; c < cells.size(); ++c)
        if (std::size_t(cells[c].body) == body)
          part.middleCols<3>(3 * m++) = r.block(first, 3 * Index(c), count, 3);
      body_r[body].noalias() = signals_[body].columns.middleRows(first, count).transpose() * part;
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto body = std::size_t(cells[c].body);
      const double weight = 1 / (cells[c].deviation * cells[c].deviation);
      cell_g[c].setZero();
      for (int k = 0; k < 3; ++k) {
        const auto x = body_r[body].col(3 * at[body] + k);
        cell_g[c].noalias() += weight * weights[c].by_cell[k].transpose() * x.head<13>();
        for (std::size_t i = 0; i < signals_[body].unknowns.size(); ++i)
          g(signals_[body].unknowns[i]) +=
              weight * weights[c].c[k].head<12>().dot(x.segment<12>(13 + 12 * Index(i)));
      }
      ++at[body];
    }
    solver.solve(g, cell_g);
    out.col(window).head(n) = g;
    for (std::size_t c = 0; c < cells.size(); ++c) out.col(window).segment<12>(n + 12 * Index(c)) = cell_g[c];
  }
  return out;
}

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
