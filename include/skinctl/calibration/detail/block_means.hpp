// SPDX-License-Identifier: BSD-3-Clause
// Readings of accelerometers as means over blocks of time that all cells share.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The readings of the accelerometer of one cell.
struct CellReadings {
  std::vector<double> time;  ///< labels [s]
  Eigen::Matrix3Xd y;        ///< readings along the sensor's axes, a column per label [g]
};

namespace detail::fit {

/// Blocks of equal length; in each of them the reading of a cell at the block's middle, of a straight line
/// through the block's samples. A cell's phase of sampling then does not matter, and no band below 1/length
/// is lost.
struct BlockMeans {
  double start = 0, length = 0;
  Eigen::MatrixXd y;                   ///< a row per block, three columns per cell; 0 where missing
  Eigen::Array<bool, -1, -1> missing;  ///< a row per block, a column per cell
  [[nodiscard]] Eigen::Index blocks() const noexcept { return y.rows(); }
  [[nodiscard]] Eigen::Index cells() const noexcept { return missing.cols(); }
  [[nodiscard]] double middle(Eigen::Index block) const noexcept {
    return start + (double(block) + 0.5) * length;
  }
  [[nodiscard]] Eigen::Index present(Eigen::Index cell) const noexcept {
    return blocks() - missing.col(cell).count();
  }
};

/// Block means from `from` to `to` [s]. Samples that are not finite, out of order or beyond `most` g are
/// dropped; a block counts if 60 % of its usual samples are there and cover it.
inline BlockMeans block_means(const std::vector<CellReadings>& cells, double from, double to, double length,
                              double most = 16) {
  require(length >= 0.005 && length <= 1, "length of a block", length, "0.005 to 1 s");
  require(to - from >= 20 * length, "time in which joints and cells report", to - from, ">= 20 blocks");
  const auto blocks = Eigen::Index(std::floor((to - from) / length));
  BlockMeans out;
  out.start = from, out.length = length;
  out.y = Eigen::MatrixXd::Zero(blocks, 3 * Eigen::Index(cells.size()));
  out.missing = Eigen::Array<bool, -1, -1>::Constant(blocks, Eigen::Index(cells.size()), true);
  struct Sum {
    double n = 0, t = 0, tt = 0;
    Eigen::Vector3d y = Eigen::Vector3d::Zero(), ty = Eigen::Vector3d::Zero();
  };
  std::vector<Sum> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const CellReadings& cell = cells[c];
    require(cell.y.cols() == Eigen::Index(cell.time.size()), "readings of a cell", double(cell.y.cols()),
            "one per label");
    sums.assign(std::size_t(blocks), {});
    double last = -1e300;
    for (std::size_t k = 0; k < cell.time.size(); ++k) {
      const Eigen::Vector3d y = cell.y.col(Eigen::Index(k));
      const double s = (cell.time[k] - from) / length;
      if (!(s >= 0 && s < double(blocks)) || !(cell.time[k] > last) || !(y.cwiseAbs().maxCoeff() <= most))
        continue;
      last = cell.time[k];
      const double t = s - std::floor(s) - 0.5;
      Sum& sum = sums[std::size_t(s)];
      sum.n += 1, sum.t += t, sum.tt += t * t, sum.y += y, sum.ty += t * y;
    }
    std::vector<double> counts;
    for (const Sum& sum : sums)
      if (sum.n > 0) counts.push_back(sum.n);
    if (counts.empty()) continue;
    std::nth_element(counts.begin(), counts.begin() + std::ptrdiff_t(counts.size() / 2), counts.end());
    const double usual = counts[counts.size() / 2];
    for (Eigen::Index k = 0; k < blocks; ++k) {
      const Sum& sum = sums[std::size_t(k)];
      if (sum.n < 0.6 * usual || sum.n < 1) continue;
      const double mean = sum.t / sum.n, spread = sum.tt / sum.n - mean * mean;
      Eigen::Vector3d value = sum.y / sum.n;
      if (sum.n >= 4) {
        if (std::abs(mean) > 0.2 || spread < 0.03) continue;
        value -= mean / spread * (sum.ty / sum.n - mean * value);
      }
      out.y.block<1, 3>(k, 3 * Eigen::Index(c)) = value.transpose();
      out.missing(k, Eigen::Index(c)) = false;
    }
  }
  return out;
}

}  // namespace detail::fit

SKINCTL_END_NAMESPACE
