// SPDX-License-Identifier: BSD-3-Clause
// The normal equations of a least squares fit, summed term by term: dense, sparse, or the cost alone.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The cost of a residual: `rho(|r|^2) / 2`, of residuals in units of their standard deviation.
struct Loss {
  enum class Kind { square, huber, cauchy };
  Kind kind = Kind::square;
  double width = 1;  ///< |r| from which a residual counts less than by its square

  /// The loss rho of a squared residual |r|^2, and its derivative by that, the weight.
  struct Value {
    double rho, weight;
  };
  [[nodiscard]] Value at(double squared) const noexcept {
    const double w2 = width * width;
    switch (kind) {
      case Kind::huber:
        if (squared > w2) return {2 * width * std::sqrt(squared) - w2, width / std::sqrt(squared)};
        break;
      case Kind::cauchy:
        return {w2 * std::log1p(squared / w2), 1 / (1 + squared / w2)};
      case Kind::square:
        break;
    }
    return {squared, 1};
  }
};

/// A view of a residual, or of its derivatives, by columns. The matrix must outlive it.
struct Columns {
  const double* data;
  int rows, cols;

  template <class M>
  Columns(const Eigen::PlainObjectBase<M>& matrix)
      : data(matrix.data()), rows(int(matrix.rows())), cols(int(matrix.cols())) {
    static_assert(!M::IsRowMajor || M::IsVectorAtCompileTime);
  }
  [[nodiscard]] const double* column(int j) const noexcept { return data + std::ptrdiff_t(j) * rows; }
  /// Dot product of column `j` with `other`, which has as many rows.
  [[nodiscard]] double dot(int j, const double* other) const noexcept {
    double sum = 0;
    for (int i = 0; i < rows; ++i) sum += column(j)[i] * other[i];
    return sum;
  }
};

/// Derivative of a residual by the unknowns from `column` on. `column < 0`: these unknowns are fixed, and it
/// does not count.
struct Partial {
  int column;
  Columns matrix;
};
/// The derivatives of one term by all unknowns on which it depends.
using Partials = std::initializer_list<Partial>;

/// Sums the cost alone, without derivatives. Used as `DenseNormal` and `SparseNormal`: `start`, then `add`
/// for each term, of residuals in units of their standard deviation.
class CostOnly {
 public:
  static constexpr bool derivatives = false;
  void start(int /*unknowns*/) noexcept { cost_ = 0; }
  void add(const Loss& loss, const Columns& r, Partials /*by*/ = {}) noexcept {
    cost_ += 0.5 * loss.at(r.dot(0, r.data)).rho;
  }
  [[nodiscard]] double cost() const noexcept { return cost_; }

 private:
  double cost_ = 0;
};

/// A covariance of what the data show, and the directions that they do not.
struct Observability {
  Eigen::MatrixXd covariance;  ///< covariance of the unknowns; 0 along the unseen directions
  Eigen::MatrixXd unseen;      ///< unit columns, of unknowns in units of their scale; the least known first
  /// Standard deviation along each column of `unseen`, in units of the scale; infinite: not observed at all.
  Eigen::VectorXd deviation;
};

/// Normal equations with `H = sum J'J` and `g = sum J'r` as dense matrices: for up to about a thousand
/// unknowns.
class DenseNormal {
 public:
  static constexpr bool derivatives = true;
  void start(int unknowns) {
    H_.setZero(unknowns, unknowns);
    g_.setZero(unknowns);
    cost_ = 0;
  }
  void add(const Loss& loss, const Columns& r, Partials by = {}) {
    const auto value = loss.at(r.dot(0, r.data));
    cost_ += 0.5 * value.rho;
    for (const Partial& a : by) {
      if (a.column < 0) continue;
      for (int i = 0; i < a.matrix.cols; ++i) g_(a.column + i) += value.weight * a.matrix.dot(i, r.data);
      for (const Partial& b : by) {
        if (b.column < 0) continue;
        for (int j = 0; j < b.matrix.cols; ++j)
          for (int i = 0; i < a.matrix.cols; ++i)
            H_(a.column + i, b.column + j) += value.weight * a.matrix.dot(i, b.matrix.column(j));
      }
    }
  }
  [[nodiscard]] double cost() const noexcept { return cost_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const noexcept { return g_; }
  [[nodiscard]] Eigen::VectorXd diagonal() const { return H_.diagonal(); }
  [[nodiscard]] const Eigen::MatrixXd& information() const noexcept { return H_; }

  /// Sets `step = -(H + diag(damping))^-1 g`; false if that matrix is not positive definite.
  [[nodiscard]] bool solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) {
    Eigen::MatrixXd A = H_;
    A.diagonal() += damping;
    const detail::Cholesky factor(A);
    if (!factor.positive()) return false;
    step = -factor.solve(g_);
    return step.allFinite();
  }

  /// The inverse of H as a covariance, without the directions that are known worse than `limit` times the
  /// unknowns' `scale`. These are returned as `unseen`: a gauge is not known badly, it is a choice.
  [[nodiscard]] Observability observed(const Eigen::VectorXd& scale, double limit) const {
    const Eigen::Index n = H_.rows();
    Eigen::MatrixXd A = H_;
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) A(i, j) *= scale(i) * scale(j);
    const detail::SymmetricEigen eigen(A);
    Eigen::MatrixXd seen =
        Eigen::MatrixXd::Zero(n, n);  // columns whose products with themselves are the covariance
    std::vector<Eigen::Index> unseen;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double value = eigen.values(k);
      if (!(value * limit * limit > 1)) {
        unseen.push_back(k);
        continue;
      }
      for (Eigen::Index i = 0; i < n; ++i) seen(i, k) = scale(i) * eigen.vectors(i, k) / std::sqrt(value);
    }
    Observability out;
    out.covariance = seen * seen.transpose();
    out.unseen.resize(n, Eigen::Index(unseen.size()));
    out.deviation.resize(Eigen::Index(unseen.size()));
    for (std::size_t k = 0; k < unseen.size(); ++k) {
      const double value = eigen.values(unseen[k]);
      out.unseen.col(Eigen::Index(k)) = eigen.vectors.col(unseen[k]);
      out.deviation(Eigen::Index(k)) =
          value > 0 ? 1 / std::sqrt(value) : std::numeric_limits<double>::infinity();
    }
    return out;
  }

 private:
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  double cost_ = 0;
};

/// A `DenseNormal` with a sparse matrix, of blocks as the terms name them: to tens of thousands of unknowns.
class SparseNormal {
 public:
  static constexpr bool derivatives = true;
  using Matrix = Eigen::SparseMatrix<double>;
  using Solver = Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>>;

  void start(int unknowns) {
    g_.setZero(unknowns);
    for (Block& block : blocks_) block.value.setZero();
    cost_ = 0;
  }
  void add(const Loss& loss, const Columns& r, Partials by = {}) {
    const auto value = loss.at(r.dot(0, r.data));
    cost_ += 0.5 * value.rho;
    for (const Partial& a : by) {
      if (a.column < 0) continue;
      for (int i = 0; i < a.matrix.cols; ++i) g_(a.column + i) += value.weight * a.matrix.dot(i, r.data);
      for (const Partial& b : by) {
        // A pair of blocks is met twice; it is kept where its rows are the lower ones.
        if (b.column < 0 || b.column > a.column) continue;
        Eigen::MatrixXd& H = of_block(a.column, b.column, a.matrix.cols, b.matrix.cols);
        for (int j = 0; j < b.matrix.cols; ++j)
          for (int i = 0; i < a.matrix.cols; ++i)
            H(i, j) += value.weight * a.matrix.dot(i, b.matrix.column(j));
      }
    }
  }
  [[nodiscard]] double cost() const noexcept { return cost_; }
  [[nodiscard]] const Eigen::VectorXd& gradient() const noexcept { return g_; }
  [[nodiscard]] Eigen::VectorXd diagonal() const {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(g_.size());
    for (const Block& b : blocks_)
      if (b.row == b.column) d.segment(b.row, std::min(b.value.rows(), b.value.cols())) += b.value.diagonal();
    return d;
  }
  /// The lower triangle of H.
  [[nodiscard]] Matrix information() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Block& b : blocks_)
      for (int j = 0; j < b.value.cols(); ++j)
        for (int i = 0; i < b.value.rows(); ++i)
          if (b.row + i >= b.column + j) entries.emplace_back(b.row + i, b.column + j, b.value(i, j));
    for (int i = 0; i < g_.size(); ++i) entries.emplace_back(i, i, 0);  // the damping's place
    Matrix H(g_.size(), g_.size());
    H.setFromTriplets(entries.begin(), entries.end());
    return H;
  }
  [[nodiscard]] bool solve(const Eigen::VectorXd& damping, Eigen::VectorXd& step) {
    Matrix A = information();
    A.diagonal() += damping;
    if (!solver_) solver_ = std::make_unique<Solver>();
    if (A.nonZeros() != analysed_) solver_->analyzePattern(A), analysed_ = A.nonZeros();
    solver_->factorize(A);
    if (solver_->info() != Eigen::Success || !(solver_->vectorD().minCoeff() > 0)) return false;
    step = -solver_->solve(g_);
    return step.allFinite();
  }

 private:
  struct Block {
    int row, column;
    Eigen::MatrixXd value;
  };
  Eigen::MatrixXd& of_block(int row, int column, int rows, int columns) {
    const std::uint64_t key = std::uint64_t(row) << 40 | std::uint64_t(column) << 16 |
                              std::uint64_t(rows & 0xff) << 8 | std::uint64_t(columns & 0xff);
    const auto [at, fresh] = index_.try_emplace(key, blocks_.size());
    if (fresh) blocks_.push_back({row, column, Eigen::MatrixXd::Zero(rows, columns)});
    return blocks_[at->second].value;
  }

  std::unordered_map<std::uint64_t, std::size_t> index_;
  std::vector<Block> blocks_;
  Eigen::VectorXd g_;
  std::unique_ptr<Solver> solver_;  // it cannot be moved
  Eigen::Index analysed_ = -1;
  double cost_ = 0;
};

SKINCTL_END_NAMESPACE
