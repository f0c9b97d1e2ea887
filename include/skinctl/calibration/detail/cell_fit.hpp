// SPDX-License-Identifier: BSD-3-Clause
// Poses of accelerometers on bodies whose motion depends on a few unknowns: the fit of `joint_lines.hpp`.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/calibration/detail/cell_equations.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// @tparam Motion  has `int unknowns()`, `void hold(VectorXd& information, VectorXd& gradient)` for its
///                 priors, `Motion moved(VectorXd)`, `std::vector<BodySignals> signals(const BlockMeans&)`.
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

  /// Runs Levenberg-Marquardt from the present state.
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
      std::vector<CellVector> cell_g = now.cell_g;
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
        column.noalias() -= phi.leftCols(13) * w.c[k];
        for (Eigen::Index row = 0; row < r.rows(); ++row)
          if (data_.missing(row, Eigen::Index(c))) column(row) = 0;
      }
    }
    return r;
  }
  /// The changes of all unknowns by the residuals of single windows of time, as columns: motion, patches,
  /// cells. The sum of their squares is the covariance that does not take residuals for white.
  [[nodiscard]] Eigen::MatrixXd jackknife(const CellSolver& solver) const;
  [[nodiscard]] const std::vector<BodySignals>& signals() const noexcept { return signals_; }
  [[nodiscard]] const BlockMeans& data() const noexcept { return data_; }
  [[nodiscard]] Eigen::Index globals() const noexcept {
    return motion.unknowns() + 6 * Eigen::Index(patches.size());
  }

 private:
  void add_cell(CellEquations& e, std::size_t c, const BodySignals& signal, const Eigen::MatrixXd& G,
                const Eigen::Ref<const Eigen::MatrixXd>& Y, const Eigen::Ref<const Eigen::MatrixXd>& X) const;
  void add_priors(CellEquations& e) const;
  void move(const Eigen::VectorXd& g, const std::vector<CellVector>& cell_g) {
    motion = motion.moved(g.head(motion.unknowns()));
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const Eigen::Index at = motion.unknowns() + 6 * Eigen::Index(k);
      patches[k].R = straightened(turn(g.segment<3>(at)) * patches[k].R);
      patches[k].p += g.segment<3>(at + 3);
    }
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = cells[c].moved(cell_g[c]);
    signals_ = motion.signals(data_);
  }

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

/// Adds a cell's readings `Y`. `G`: normal matrix of its body's columns in its blocks; `X`: these times `Y`.
template <class Motion>
void CellFit<Motion>::add_cell(CellEquations& e, std::size_t c, const BodySignals& signal,
                               const Eigen::MatrixXd& G, const Eigen::Ref<const Eigen::MatrixXd>& Y,
                               const Eigen::Ref<const Eigen::MatrixXd>& X) const {
  using Index = Eigen::Index;
  const Index width = signal.columns.cols(), unknowns = Index(signal.unknowns.size());
  const CellWeights w(cells[c]);
  const double weight = 1 / (cells[c].deviation * cells[c].deviation);
  const Eigen::MatrixXd own = G.topLeftCorner(13, 13);
  Eigen::MatrixXd T(width, unknowns), across, by_own;
  for (int k = 0; k < 3; ++k) {
    // Of the body's columns: those of the cell's place, and by unknown of the motion.
    const Eigen::VectorXd &v = w.c[k], y = Y.col(k), x = X.col(k);
    const Eigen::VectorXd seen = own * v, rest = x.head(13) - seen, pulled = w.by_cell[k].transpose() * rest;
    e.squares[c] += y.squaredNorm() - v.dot(x.head(13)) - v.dot(rest);
    by_own.noalias() = own * w.by_cell[k];
    across.noalias() = w.by_cell[k].transpose() * by_own;
    for (Index j = 0; j < cell_unknowns; ++j) {
      e.cell_g[c](j) += weight * pulled(j);
      for (Index i = 0; i < cell_unknowns; ++i) e.cell_H[c](i, j) += weight * across(i, j);
    }
    T.setZero();
    for (Index i = 0; i < unknowns; ++i)
      for (Index a = 0; a < 12; ++a)
        for (Index column = 0; column < width; ++column) T(column, i) += v(a) * G(column, 13 + 12 * i + a);
    by_own.noalias() = w.by_cell[k].transpose() * T.topRows(13);  // cell_unknowns x unknowns
    for (Index i = 0; i < unknowns; ++i) {
      const Index row = signal.unknowns[std::size_t(i)];
      double pull = 0;
      for (Index a = 0; a < 12; ++a) pull += v(a) * x(13 + 12 * i + a);
      for (Index a = 0; a < 13; ++a) pull -= T(a, i) * v(a);
      e.g(row) += weight * pull;
      for (Index a = 0; a < cell_unknowns; ++a) e.cross[c](row, a) += weight * by_own(a, i);
      for (Index j = 0; j <= i; ++j) {
        double h = 0;
        for (Index a = 0; a < 12; ++a) h += T(13 + 12 * j + a, i) * v(a);
        const Index column = signal.unknowns[std::size_t(j)];
        e.H(row, column) += weight * h;
        if (i != j) e.H(column, row) += weight * h;
      }
    }
  }
  e.cost += 0.5 * weight * e.squares[c];
}

/// Adds the priors of cells, patches and the motion.
template <class Motion>
void CellFit<Motion>::add_priors(CellEquations& e) const {
  using Index = Eigen::Index;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const double bias = 1 / (settings.bias * settings.bias), scale = 1 / (settings.scale * settings.scale);
    const double place = 1 / (settings.weak_position * settings.weak_position);
    const double angle = 1 / (settings.weak_turn * settings.weak_turn);
    const double across = 2 / (settings.cross_axis * settings.cross_axis);  // of the mean of two
    e.cost += 0.5 * (bias * cells[c].b.squaredNorm() + scale * cells[c].s.squaredNorm() +
                     across * cells[c].x.squaredNorm());
    const double held[5] = {angle, place, bias, scale, across};
    for (int k = 0; k < cell_unknowns; ++k) e.cell_H[c](k, k) += held[k / 3];
    for (int k = 0; k < 3; ++k)
      e.cell_g[c](6 + k) -= bias * cells[c].b(k), e.cell_g[c](9 + k) -= scale * cells[c].s(k),
          e.cell_g[c](12 + k) -= across * cells[c].x(k);
    if (cells[c].patch >= 0)
      tie(cells[c], c, patches[std::size_t(cells[c].patch)], motion.unknowns() + 6 * cells[c].patch, settings,
          e);
  }
  const Index own = motion.unknowns();
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(own), gradient = diagonal;
  motion.hold(diagonal, gradient);
  for (Index k = 0; k < own; ++k) {
    e.H(k, k) += diagonal(k) + 1 / (settings.weak_position * settings.weak_position);
    e.g(k) += gradient(k);
    e.cost += 0.5 * gradient(k) * gradient(k) / std::max(diagonal(k), 1e-300);
  }
  for (Index k = own; k < globals(); ++k) e.H(k, k) += 1e-6;
}

template <class Motion>
CellEquations CellFit<Motion>::equations() const {
  using Index = Eigen::Index;
  const Index n = globals();
  CellEquations e;
  e.H = Eigen::MatrixXd::Zero(n, n), e.g = Eigen::VectorXd::Zero(n);
  e.cell_H.assign(cells.size(), Eigen::MatrixXd::Zero(cell_unknowns, cell_unknowns));
  e.cell_g.assign(cells.size(), CellVector::Zero());
  e.cross.assign(cells.size(), Eigen::MatrixXd::Zero(n, cell_unknowns));
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
    gram.noalias() = phi.transpose() * phi;
    Y.resize(phi.rows(), 3 * Index(members.size()));
    for (std::size_t m = 0; m < members.size(); ++m)
      Y.middleCols(3 * Index(m), 3) = data_.y.middleCols(3 * members[m], 3);
    X.noalias() = phi.transpose() * Y;
    for (std::size_t m = 0; m < members.size(); ++m) {
      const auto c = std::size_t(members[m]);
      lost.clear();
      for (Index k = 0; k < data_.blocks(); ++k)
        if (data_.missing(k, Index(c))) lost.push_back(k);
      const Eigen::MatrixXd* G = &gram;
      if (!lost.empty()) {
        Eigen::MatrixXd rows(Index(lost.size()), phi.cols());
        for (std::size_t k = 0; k < lost.size(); ++k) rows.row(Index(k)) = phi.row(lost[k]);
        own_gram = gram;
        own_gram.noalias() -= rows.transpose() * rows;
        G = &own_gram;
      }
      add_cell(e, c, signal, *G, Y.middleCols(3 * Index(m), 3), X.middleCols(3 * Index(m), 3));
    }
  }
  add_priors(e);
  return e;
}

template <class Motion>
Eigen::MatrixXd CellFit<Motion>::jackknife(const CellSolver& solver) const {
  using Index = Eigen::Index;
  const Eigen::MatrixXd r = residuals();
  const auto rows = std::max<Index>(1, Index(std::lround(settings.window / data_.length)));
  const Index windows = std::max<Index>(1, data_.blocks() / rows), n = globals();
  Eigen::MatrixXd out(n + cell_unknowns * Index(cells.size()), windows);
  Eigen::MatrixXd X;
  Eigen::VectorXd g;
  std::vector<CellVector> cell_g(cells.size());
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
          part.middleCols(3 * m++, 3) = r.block(first, 3 * Index(c), count, 3);
      body_r[body].noalias() = signals_[body].columns.middleRows(first, count).transpose() * part;
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto body = std::size_t(cells[c].body);
      const double weight = 1 / (cells[c].deviation * cells[c].deviation);
      cell_g[c].setZero();
      for (int k = 0; k < 3; ++k) {
        const Eigen::VectorXd x = body_r[body].col(3 * at[body] + k), own = x.head(13),
                              pulled = weights[c].by_cell[k].transpose() * own;
        for (Index a = 0; a < cell_unknowns; ++a) cell_g[c](a) += weight * pulled(a);
        for (Index a = 0; a < 12; ++a)
          for (std::size_t i = 0; i < signals_[body].unknowns.size(); ++i)
            g(signals_[body].unknowns[i]) += weight * weights[c].c[k](a) * x(13 + 12 * Index(i) + a);
      }
      ++at[body];
    }
    solver.solve(g, cell_g);
    out.col(window).head(n) = g;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (Index a = 0; a < cell_unknowns; ++a) out(n + cell_unknowns * Index(c) + a, window) = cell_g[c](a);
  }
  return out;
}
}  // namespace detail::fit
SKINCTL_END_NAMESPACE
