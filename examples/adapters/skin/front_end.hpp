// FrontEnd: a cell's calibration, from what it reads at rest and under forces that are known.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/tactile/channel_calibration.hpp"

namespace adapters::skin {

/// Finds the `ChannelCalibration` of a cell: `y = A (x - rest)`, with A of the least squares of known forces,
/// in newtons: a kitchen scale under the pad, weights on it, or an arm with a sensor in its wrist. Readings
/// that no channel pushes with (temperatures) have no part in A.
///
/// It allocates, and belongs before a run. A pad that drifts, as magnets do with their temperature, is set to
/// rest again by `at_rest`, which keeps A.
template <skinctl::SensorKind Kind>
class FrontEnd {
  using Table = skinctl::KindTable<Kind>;
  static constexpr std::size_t rows = Table::pushing, columns = Table::readings;

 public:
  using Sample = skinctl::SampleOf<Kind>;
  using Amounts = std::array<double, rows>;  ///< of the channels that push, in their order [N]
  struct Found {
    skinctl::ChannelCalibration<Kind> calibration;
    Amounts error{};  ///< root of the mean square of what the calibration leaves of the known forces [N]
  };

  /// Takes a sample of the cell with nothing on it.
  void rest(const Sample& s) {
    sum_ += readings(s);
    ++rests_;
  }
  /// Takes a sample under known forces.
  void press(const Sample& s, const Amounts& newtons) {
    x_.push_back(readings(s));
    y_.push_back(Eigen::Map<const Y>(newtons.data()));
  }
  /// The calibration of these samples.
  ///
  /// @param ridge  how strongly entries of A are held small, as a share of the mean square of the readings:
  /// with more readings than kinds of presses (15 and 3, of a pad) noise would fill A. Throws
  /// `ConfigurationError` for fewer than 10 samples at rest or 10 presses, a ridge outside of [1e-12, 1], or
  /// readings that no press changes.
  [[nodiscard]] Found find(double ridge = 1e-4) const {
    skinctl::require(x_.size() >= 10, "FrontEnd: samples under known forces", double(x_.size()), ">= 10");
    skinctl::require(ridge >= 1e-12 && ridge <= 1, "FrontEnd: ridge", ridge, "1e-12 to 1");
    const X rest = mean();
    Eigen::Matrix<double, int(columns), int(columns)> xx;
    Eigen::Matrix<double, int(columns), int(rows)> xy;
    xx.setZero(), xy.setZero();
    for (std::size_t k = 0; k < x_.size(); ++k) {
      const X d = pushing(x_[k] - rest);
      xx += d * d.transpose(), xy += d * y_[k].transpose();
    }
    const double size = xx.trace() / double(columns);
    skinctl::require(size > 0, "FrontEnd: mean square of what the presses changed", size, "> 0");
    xx.diagonal().array() += ridge * size;
    const Eigen::Matrix<double, int(rows), int(columns)> A = xx.ldlt().solve(xy).transpose();
    Found out;
    for (std::size_t c = 0; c < rows; ++c)
      for (std::size_t r = 0; r < columns; ++r)
        out.calibration.A[c][r] = static_cast<float>(A(int(c), int(r)));
    out.calibration = at_rest(out.calibration);
    for (std::size_t k = 0; k < x_.size(); ++k) {
      const Y left = A * pushing(x_[k] - rest) - y_[k];
      for (std::size_t c = 0; c < rows; ++c) out.error[c] += left[int(c)] * left[int(c)];
    }
    for (double& e : out.error) e = std::sqrt(e / double(x_.size()));
    return out;
  }
  /// A calibration found before, with the rest of these samples: `b = -A rest`. Throws as `find` does for the
  /// rest.
  [[nodiscard]] skinctl::ChannelCalibration<Kind> at_rest(
      skinctl::ChannelCalibration<Kind> calibration) const {
    const X rest = mean();
    for (std::size_t c = 0; c < rows; ++c) {
      double b = 0;
      for (std::size_t r = 0; r < columns; ++r) b -= double(calibration.A[c][r]) * rest[int(r)];
      calibration.b[c] = static_cast<float>(b);
    }
    calibration.check();
    return calibration;
  }

 private:
  using X = Eigen::Matrix<double, int(columns), 1>;
  using Y = Eigen::Matrix<double, int(rows), 1>;

  static X readings(const Sample& s) {
    const auto x = skinctl::detail::readings_of(s);
    X out;
    for (std::size_t r = 0; r < columns; ++r) out[int(r)] = double(x[r]);
    return out;
  }
  static X pushing(X x) {
    std::uint32_t bits = 0;
    for (std::size_t c = 0; c < rows; ++c) bits |= Kind::channels[c].readings;
    for (std::size_t r = 0; r < columns; ++r)
      if (((bits >> r) & 1u) == 0) x[int(r)] = 0;
    return x;
  }
  X mean() const {
    skinctl::require(rests_ >= 10, "FrontEnd: samples at rest", double(rests_), ">= 10");
    return sum_ / double(rests_);
  }

  X sum_ = X::Zero();
  std::size_t rests_ = 0;
  std::vector<X, Eigen::aligned_allocator<X>> x_;
  std::vector<Y, Eigen::aligned_allocator<Y>> y_;
};

}  // namespace adapters::skin
