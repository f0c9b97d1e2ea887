// SPDX-License-Identifier: BSD-3-Clause
// The noise of an untouched cell, and the threshold above which its reading is a touch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Reasons for which the noise of a cell was not taken, in the order of their checks.
enum class NoiseFinding : unsigned char {
  good,    ///< the noise was taken
  silent,  ///< fewer than two samples, a value that is not finite, or a time that is not later
  near,    ///< something was near: proximity above `NoiseSettings::near`, or NaN
  offset,  ///< pressed all the time: the mean is above the file's threshold
  drift    ///< the mean of the second half differs from that of the first
};
constexpr const char* describe(NoiseFinding f) noexcept {
  constexpr const char* text[] = {"good", "the cell is silent", "something is near the cell",
                                  "the cell is pressed, or its rest level is another than the file's",
                                  "the reading drifts"};
  return f <= NoiseFinding::drift ? text[static_cast<unsigned>(f)] : "unknown";
}

/// Rest level and threshold of a cell, in units of its reading.
struct CellNoise {
  double rest = 0;    ///< reading of the untouched cell
  double margin = 0;  ///< margin of a touch above the rest level
  double sigma = 0;   ///< standard deviation of the reading, rounding included
  NoiseFinding finding = NoiseFinding::good;
  [[nodiscard]] constexpr double threshold() const noexcept { return rest + margin; }
};

struct NoiseSettings {
  double step = 1.0 / 1024;  ///< step of the reading (LSB), > 0
  double near = 0.05;        ///< proximity from which the cell is not alone, in (0, 1]
  /// Throws `ConfigurationError` for a number out of its range.
  void check() const {
    require(step > 0 && step <= 1, "NoiseSettings: step", step, "> 0, <= 1");
    require(near > 0 && near <= 1, "NoiseSettings: near", near, "> 0, <= 1");
  }
};

/// One reading with its time and the proximity beside it.
struct NoiseReading {
  Nanoseconds time{};
  double value = 0, proximity = 0;
};

/// The noise of a cell from its readings, in the order of their times, over a time (2 s are usual) in which
/// nothing touches it:
///
///     margin = max(6 sigma, 1.5 (max - median), 2 steps),    sigma^2 = variance + step^2 / 12
///
/// A reading counts for the time until the next one, so a cell that sends only changes has the same noise as
/// one that sends all. Where something else than noise is found, or a value or its square is not finite,
/// `file` stays, and the finding says why. The means of both halves differ by drift if by more than 6 of
/// their standard errors, which successive differences give, and by a step.
///
/// Throws `ConfigurationError` for settings out of range; not for the loop: it sorts. The order of `readings`
/// is changed.
///
/// @param file  rest level and margin that hold so far.
inline CellNoise cell_noise(std::span<NoiseReading> readings, const CellNoise& file,
                            const NoiseSettings& s = {}) {
  s.check();
  const auto kept = [&](NoiseFinding why) {
    CellNoise out = file;
    out.finding = why;
    return out;
  };
  const std::size_t n = readings.size();
  if (n < 2) return kept(NoiseFinding::silent);
  const Nanoseconds from = readings.front().time, middle = from + (readings.back().time - from) / 2;
  double weight[2] = {}, sum[2] = {}, changes = 0, largest = readings[0].value;
  // Each weight in place of the proximity, which is read before.
  for (std::size_t i = 0; i < n; ++i) {
    NoiseReading& r = readings[i];
    if (!(r.value - r.value == 0)) return kept(NoiseFinding::silent);
    if (!(r.proximity <= s.near)) return kept(NoiseFinding::near);
    // The last one counts as long as the one before it.
    r.proximity = seconds<double>(i + 1 < n ? readings[i + 1].time - r.time : r.time - readings[i - 1].time);
    if (!(r.proximity > 0)) return kept(NoiseFinding::silent);
    if (i > 0) changes += (r.value - readings[i - 1].value) * (r.value - readings[i - 1].value);
    const std::size_t half = r.time < middle ? 0 : 1;
    weight[half] += r.proximity;
    sum[half] += r.proximity * r.value;
    largest = std::max(largest, r.value);
  }
  const double all = weight[0] + weight[1], mean = (sum[0] + sum[1]) / all;
  double variance = 0;
  for (const NoiseReading& r : readings) variance += r.proximity / all * (r.value - mean) * (r.value - mean);
  if (!(variance + changes < HUGE_VAL)) return kept(NoiseFinding::silent);
  const double rounding = s.step * s.step / 12;
  CellNoise out{.rest = mean, .sigma = std::sqrt(variance + rounding)};
  if (mean > file.threshold()) return kept(NoiseFinding::offset);
  const double white = 0.5 * changes / static_cast<double>(n - 1) + rounding;
  const double error = std::sqrt(white * 4 / static_cast<double>(n));
  if (std::abs(sum[1] / weight[1] - sum[0] / weight[0]) > 6 * error + s.step)
    return kept(NoiseFinding::drift);
  std::sort(readings.begin(), readings.end(),
            [](const NoiseReading& a, const NoiseReading& b) { return a.value < b.value; });
  double below = 0, median = largest;
  for (const NoiseReading& r : readings) {
    below += r.proximity;
    if (2 * below >= all) {
      median = r.value;
      break;
    }
  }
  out.margin = std::max({6 * out.sigma, 1.5 * (largest - median), 2 * s.step});
  return out;
}

/// Collects the samples of a skin's cells while nobody touches it, and gives the noise of each: of the sum of
/// its three force readings.
class NoiseCalibration {
 public:
  /// Throws `ConfigurationError` for settings out of range.
  /// @param file  rest level and margin of each cell so far, in the order of the skin's cells.
  explicit NoiseCalibration(std::vector<CellNoise> file, const NoiseSettings& settings = {})
      : settings_(settings), file_(std::move(file)), readings_(file_.size()) {
    settings.check();
  }
  /// Takes a sample of the `i`-th cell; those of one cell in the order of their times. Allocates.
  void add(std::size_t i, const CellSample& sample) {
    SKINCTL_EXPECTS(i < readings_.size(), "a cell of this skin");
    const auto& f = sample.force;
    readings_[i].push_back(
        {sample.time, double(f[0]) + double(f[1]) + double(f[2]), double(sample.proximity)});
  }
  /// The noise of every cell.
  [[nodiscard]] std::vector<CellNoise> result() const {
    std::vector<CellNoise> out;
    for (std::size_t i = 0; i < file_.size(); ++i) {
      auto readings = readings_[i];
      out.push_back(cell_noise(readings, file_[i], settings_));
    }
    return out;
  }

 private:
  NoiseSettings settings_;
  std::vector<CellNoise> file_;
  std::vector<std::vector<NoiseReading>> readings_;
};

/// Filter over two samples in a row: the smaller one of the last two counts, so that a single peak of noise
/// is no touch. A touch is felt one sample later, a release at once.
///
/// A cell that sends only changes measures without sending: once it has been silent for two of its periods,
/// its last sample has proved itself, and `settled` counts. For the front end of a skin, in the loop.
class TwoInARow {
 public:
  struct Memory {
    CellCounts last;  ///< the newest sample; nothing at first
  };
  [[nodiscard]] SKINCTL_INLINE static constexpr CellCounts take(Memory& m, CellCounts now) noexcept {
    const CellCounts before = m.last;
    m.last = now;
    return {std::min(before.force, now.force), std::min(before.proximity, now.proximity)};
  }
  [[nodiscard]] SKINCTL_INLINE static constexpr CellCounts settled(const Memory& m) noexcept {
    return m.last;
  }
};

SKINCTL_END_NAMESPACE
