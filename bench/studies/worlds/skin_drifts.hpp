// What skin cells read in a day: drifts, contacts of an hour, noise; at any rate and by events. Each one is a
// function of time, so that it can be sampled in any way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// A change of what an untouched cell reads. Times in s, readings in steps of the sensor.
struct SkinDrift {
  enum class Kind {
    patch,      ///< all cells of a patch alike, as when it warms up: at `rate` until `size`
    cell,       ///< the same, of one cell alone
    creep,      ///< begins at `rate` and settles at `size`, as rubber under load or after it
    discharge,  ///< jumps by `size` within 5 ms, and goes back, at first at `rate`
  };
  Kind kind = Kind::cell;
  double begin = 0;
  double size = 0;  ///< [steps]
  double rate = 1;  ///< [steps/s], > 0

  /// The change at time `t` [steps].
  [[nodiscard]] double operator()(double t) const {
    const double since = t - begin;
    if (since <= 0) return 0;
    switch (kind) {
      case Kind::patch:
      case Kind::cell:
        return std::min(size, rate * since);
      case Kind::creep:
        return size * -std::expm1(-since * rate / size);
      case Kind::discharge:
        return size * std::min(1.0, since / 0.005) * std::exp(-since * rate / size);
    }
    return 0;
  }
};

/// A drift of 2 to 40 steps/s (a discharge goes back within 1 to 20 minutes) to 0.3 to 4 thresholds.
/// @param threshold  of a touch [steps].
[[nodiscard]] inline SkinDrift random_drift(Seeded& rng, SkinDrift::Kind kind, double threshold,
                                            double begin) {
  SkinDrift drift{kind, begin, threshold * rng.between(0.3, 4), 2 * std::pow(20.0, rng.between(0, 1))};
  if (kind == SkinDrift::Kind::discharge) drift.rate = drift.size / (60 * std::pow(20.0, rng.between(0, 1)));
  return drift;
}

/// A contact: what the force sensors, the proximity sensor and the thermometer of a cell see of it.
struct DriftingTouch {
  double begin = 0, lasts = 1;  ///< [s]
  double size = 0;              ///< [steps]
  double rise = 0.05;           ///< time in which it grows at its beginning and fades at its end [s]
  bool blind = false;           ///< the proximity sensor does not see what touches: black cloth, a glove
  double warmth = 0;            ///< what touches is so much warmer than the cell [K]

  /// The force readings' part at `t` [steps].
  [[nodiscard]] double force(double t) const {
    if (t <= begin || t >= begin + lasts) return 0;
    return size * std::min({1.0, (t - begin) / rise, (begin + lasts - t) / rise});
  }
  /// In [0, 1]: near 0.8 in the contact, from 0.3 s before to 0.3 s after it; 0.02 with nothing to be seen.
  [[nodiscard]] double proximity(double t) const {
    const double nothing = 0.02, near = 0.3;
    if (blind || t <= begin - near || t >= begin + lasts + near) return nothing;
    const double share = std::min({1.0, (t - begin + near) / near, (begin + lasts + near - t) / near});
    return nothing + 0.78 * share;
  }
  /// Change of the cell's temperature [K]: it follows the object within a minute.
  [[nodiscard]] double warming(double t) const {
    const double tau = 60;
    if (t <= begin) return 0;
    const double end = std::min(t, begin + lasts);
    return warmth * -std::expm1(-(end - begin) / tau) * std::exp(-(t - end) / tau);
  }
};

/// How often contacts are of the kinds that are mistaken for drifts.
struct ContactShares {
  double blind = 0.02;  ///< not seen by proximity
  double slow = 0.15;   ///< grows within 5 to 60 s instead of 10 to 500 ms
  double warm = 0.3;    ///< of something 2 to 12 K warmer
};
/// A contact of `lasts` seconds, of `least` to `most` steps.
[[nodiscard]] inline DriftingTouch random_contact(Seeded& rng, double begin, double lasts, double least,
                                                  double most, const ContactShares& shares = {}) {
  DriftingTouch contact{begin, lasts, rng.between(least, most), 0.05, false, 0};
  contact.blind = rng.between(0, 1) < shares.blind;
  contact.rise =
      rng.between(0, 1) < shares.slow ? rng.between(5, 60) : 0.01 * std::pow(50.0, rng.between(0, 1));
  if (rng.between(0, 1) < shares.warm) contact.warmth = rng.between(2, 12);
  return contact;
}
/// A tap of 6 ms: what a finger nail or a thrown crumb gives.
[[nodiscard]] inline DriftingTouch tap(double begin, double size) {
  return {begin, 0.006, size, 0.001, false, 0};
}

/// Noise and steps of a sensor: near to normal, from four uniform numbers, so within +-3.46 deviations and
/// the same on every machine.
class ReadingNoise {
 public:
  /// @param sigma  standard deviation before rounding [steps].
  explicit ReadingNoise(double sigma, std::uint64_t seed = 1)
      : random_(seed), scale_(sigma * std::sqrt(3.0)) {}
  /// What the sensor says of `x` [steps]: with noise, rounded to whole steps, at least 0.
  [[nodiscard]] double operator()(double x) {
    const std::uint64_t bits = random_();
    double sum = -2;
    for (int k = 0; k < 4; ++k) sum += static_cast<double>((bits >> (16 * k)) & 0xffff) / 65535.0;
    return std::max(0.0, std::round(x + scale_ * sum));
  }

 private:
  Random random_;
  double scale_;
};

/// Calls `f(t)` at `rate` [Hz], for `from < t <= to`.
template <class F>
void at_rate(double rate, double from, double to, F&& f) {
  const auto n = static_cast<std::int64_t>(std::floor((to - from) * rate + 1e-9));
  for (std::int64_t k = 1; k <= n; ++k) f(from + static_cast<double>(k) / rate);
}

/// A cell that sends by events: it measures `x(t)` at `rate` and calls `f(t, x)` when the value differs by at
/// least `delta` [steps] from the last sent, and every `keep_alive` [s].
template <class X, class F>
void by_events(X&& x, double rate, double delta, double keep_alive, double from, double to, F&& f) {
  double sent = 0, when = from - 2 * keep_alive;
  at_rate(rate, from, to, [&](double t) {
    const double now = x(t);
    if (std::abs(now - sent) < delta && t - when < keep_alive - 1e-9) return;
    sent = now, when = t;
    f(t, now);
  });
}

}  // namespace skinctl::testing
