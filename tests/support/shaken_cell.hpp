// What the accelerometer of a cell reads on an arm that moves, is hit, and on which something slips: a
// generator.
#pragma once

#include <cmath>
#include <random>

#include "skinctl/core/time.hpp"
#include "skinctl/core/triple.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// An accelerometer with noise and steps, on a link whose motion is known but for an error: slow sways, as of
/// joints that are not as modelled.
class ShakenCell {
 public:
  struct Settings {
    double rate = 250;          ///< [Hz]
    double noise = 0.05;        ///< standard deviation of an axis [m/s^2]
    double step = 0.0383;       ///< of the sensor: 1/256 g [m/s^2]
    double motion_error = 0.1;  ///< amplitude of what is not predicted of the link's motion [m/s^2]
    double jitter = 0.2;        ///< of the stamps, in parts of the period
  };
  explicit ShakenCell(std::uint64_t seed) : ShakenCell(seed, Settings()) {}
  ShakenCell(std::uint64_t seed, const Settings& s) : s_(s), rng_(seeded(seed)) {
    for (double& f : frequency_) f = uniform(rng_, 0.3, 4.0);
  }
  [[nodiscard]] Nanoseconds time() const { return now_; }

  /// The next reading less what was predicted.
  /// @param slip  rms of the vibration of an axis [m/s^2]; `hit`: an impact's acceleration along z [m/s^2].
  Xyz<double> next(double slip = 0, double hit = 0) {
    t_ += (1 + s_.jitter * uniform(rng_, -1.0, 1.0)) / s_.rate;
    now_ = nanoseconds(t_);
    double a[3];
    for (int k = 0; k < 3; ++k) {
      const double sway = s_.motion_error * std::sin(6.283185307 * frequency_[k] * t_ + k);
      const double x = sway + s_.noise * normal_(rng_) + slip * normal_(rng_) + (k == 2 ? hit : 0);
      a[k] = s_.step * std::round(x / s_.step);
    }
    return {a[0], a[1], a[2]};
  }

 private:
  Settings s_;
  Random rng_;
  std::normal_distribution<double> normal_;
  double frequency_[3];
  double t_ = 0;
  Nanoseconds now_{};
};

}  // namespace skinctl::testing
