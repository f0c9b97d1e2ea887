// SPDX-License-Identifier: BSD-3-Clause
// Calibration of a cell: amounts of its channels as affine functions of its readings.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Calibration of a cell: the amounts y of its channels as `y = A x + b` of all its readings x, in place of
/// the sums that its kind states. It removes cross-talk, or gives forces from magnetic fields. It applies
/// before rest levels and gates; the ranges of readings are checked as they are sent.
template <SensorKind Kind>
struct ChannelCalibration {
  static constexpr std::size_t rows = KindTable<Kind>::pushing, columns = KindTable<Kind>::readings;
  std::array<std::array<float, columns>, rows> A{};  ///< factors, channel's unit per reading's
  std::array<float, rows> b{};                       ///< offset of each channel's amount, in its unit

  /// The calibration that gives the sums of readings that the kind states.
  [[nodiscard]] static constexpr ChannelCalibration identity() noexcept {
    ChannelCalibration out;
    for (std::size_t c = 0; c < rows; ++c)
      for (std::size_t r = 0; r < columns; ++r)
        out.A[c][r] = ((Kind::channels[c].readings >> r) & 1u) ? 1.0f : 0.0f;
    return out;
  }
  /// Throws `ConfigurationError` for a number that is not finite, and for entries so large that an amount
  /// could overflow.
  SKINCTL_COLD void check() const {
    for (std::size_t c = 0; c < rows; ++c) {
      require(b[c] - b[c] == 0, "ChannelCalibration: b", double(b[c]), "finite");
      double most = 0;
      for (std::size_t r = 0; r < columns; ++r) {
        const double low = Kind::readings[r].min, high = Kind::readings[r].max;
        const double x = high > -low ? high : -low;
        require(A[c][r] - A[c][r] == 0, "ChannelCalibration: A", double(A[c][r]), "finite");
        most += double(A[c][r] < 0 ? -A[c][r] : A[c][r]) * x;
      }
      require(most < 1e30, "ChannelCalibration: A times the ranges of the readings", most, "< 1e30");
    }
  }
  [[nodiscard]] SKINCTL_INLINE std::array<float, rows> amounts(const float* x) const noexcept {
    std::array<float, rows> y = b;
    for (std::size_t c = 0; c < rows; ++c)
      for (std::size_t r = 0; r < columns; ++r) y[c] += A[c][r] * x[r];
    return y;
  }
};

/// A skin with calibrated cells: one calibration for each in the order of the patches, or one for all. Throws
/// `ConfigurationError` for another number, and for what `ChannelCalibration::check` refuses.
template <class S>
[[nodiscard]] SKINCTL_COLD S calibrated(S skin,
                                        std::vector<ChannelCalibration<typename S::kind>> calibration) {
  skin.calibrate(std::move(calibration));
  return skin;
}

SKINCTL_END_NAMESPACE
