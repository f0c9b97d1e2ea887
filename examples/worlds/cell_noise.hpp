// Noise of untouched cells: Gaussian with heavier tails, drift, rounded to the sensor's steps.
#pragma once

#include <cmath>
#include <cstdint>

#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// The reading of an untouched cell, in the unit of a `CellSample` (full scale: 1).
class NoisyCell {
 public:
  struct Settings {
    double rest = 0.012, sigma = 0.001;  ///< mean and standard deviation of the reading
    double step = 1.0 / 1024;            ///< step to which the reading is rounded
    double tail = 0, tail_sigma = 3;     ///< share of samples with a larger noise, and its sigma over `sigma`
    double drift = 0;                    ///< drift of the reading [1/s]
  };
  NoisyCell(const Settings& settings, std::uint64_t seed) : s_(settings), random_(seeded(seed)) {}

  /// The next reading, at `t` [s]: mean, drift and noise, rounded to a step.
  double operator()(double t) {
    const double u = uniform(random_, 1e-300, 1.0), v = uniform(random_, 0.0, 6.283185307179586);
    const double gauss = std::sqrt(-2 * std::log(u)) * std::cos(v);
    const double wide = uniform(random_, 0.0, 1.0) < s_.tail ? s_.tail_sigma : 1;
    return s_.step * std::round((s_.rest + s_.drift * t + wide * s_.sigma * gauss) / s_.step);
  }
  /// Probability that a reading is above `threshold`, without drift; in closed form.
  [[nodiscard]] double above(double threshold) const {
    // The lowest reading above it begins half a step below itself.
    const double edge = s_.step * (std::floor(threshold / s_.step) + 0.5);
    const auto beyond = [&](double sigma) {
      return 0.5 * std::erfc((edge - s_.rest) / (sigma * std::sqrt(2.0)));
    };
    return (1 - s_.tail) * beyond(s_.sigma) + s_.tail * beyond(s_.tail_sigma * s_.sigma);
  }

 private:
  Settings s_;
  Random random_;
};

}  // namespace skinctl::testing
