// A notch filter for sensors that sample at a steady rate.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Frequency, width and sampling of a `Notch`.
struct NotchSettings {
  double frequency = 50;  ///< that is taken out [Hz], below 0.45 of the rate
  double width = 5;       ///< between the frequencies at -3 dB [Hz]
  double rate = 1000;     ///< mean rate of the samples [Hz]
  double jitter = 0;      ///< declared: rms deviation of a sample's distance to the next, in periods
};

/// Takes one frequency out of a signal: a biquad with zeros on the unit circle, for the mean rate of the samples.
///
/// It needs samples at a steady rate. With distances that deviate by 9 % rms it leaves a sixth of the tone, and of
/// a sensor that sends only changes it makes a signal of its own. So
/// - a declared `jitter` above 0.1 is refused at construction;
/// - the distances are watched (over about 50 samples): while they deviate by more than 10 % rms, the signal passes
///   unfiltered, and `regular` is false. Between the two it fades over 50 samples.
///
/// A sample that is not finite (`sample_not_finite`) or not later than the last one (`time_backwards`) is ignored;
/// after a gap of more than 10 periods the filter begins anew, at rest at the sample.
template <Real T = double>
class Notch {
 public:
  static constexpr double most_jitter = 0.1;

  /// Trivially copyable; `Memory{}` has no sample.
  struct Memory {
    Nanoseconds time{};
    T first{}, second{};  ///< of the transposed form
    T output{};
    T deviation{};    ///< mean square of the distances' relative deviation
    T weight = T(1);  ///< of the filtered signal
    bool started = false;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  explicit Notch(const NotchSettings& s) : period_(nanoseconds(1 / s.rate)) {
    require(s.rate >= 0.1 && s.rate <= 1e6, "Notch: rate", s.rate, "0.1 to 1e6 Hz");
    require(s.frequency > 0 && s.frequency <= 0.45 * s.rate, "Notch: frequency", s.frequency,
            "> 0, at most 0.45 of the rate [Hz]");
    require(s.width > 0 && s.width <= s.frequency, "Notch: width", s.width,
            "> 0, at most the frequency [Hz]");
    require(s.jitter >= 0 && s.jitter <= most_jitter, "Notch: jitter", s.jitter,
            "0 to 0.1: a notch needs samples at a steady rate");
    constexpr double turn = 6.283185307179586;
    const double w = turn * s.frequency / s.rate, a = std::tan(0.5 * turn * s.width / s.rate);
    b0_ = T(1 / (1 + a));
    b1_ = T(-2 * std::cos(w) / (1 + a));
    a2_ = T((1 - a) / (1 + a));
  }

  /// One sample; the filtered one is `memory.output`.
  Status sample(Memory& m, Nanoseconds time, const T& x) const noexcept {
    if (!(x - x == T(0))) return Reason::sample_not_finite;
    if (m.started && time <= m.time) return Reason::time_backwards;
    const auto ns = static_cast<std::uint64_t>(time.count()) - static_cast<std::uint64_t>(m.time.count());
    const double distance = static_cast<double>(ns) / static_cast<double>(period_.count());
    if (!m.started || distance > 10) {
      const Memory before = m;
      // The state of a constant input x.
      m = {time, x - b0_ * x, b0_ * x - a2_ * x, x, T(0), T(1), true};
      if (before.started) m.deviation = before.deviation + T(1.0 / 50), m.weight = before.weight;
      fade(m);
      return {};
    }
    const T off = static_cast<T>(distance - 1);
    m.deviation = m.deviation + (off * off - m.deviation) * T(1.0 / 50);
    fade(m);
    const T y = b0_ * x + m.first;
    m.first = b1_ * x - b1_ * y + m.second;
    m.second = b0_ * x - a2_ * y;
    m.output = x + m.weight * (y - x);
    m.time = time;
    return {};
  }
  /// Whether the samples come steadily enough.
  [[nodiscard]] static bool regular(const Memory& m) noexcept {
    return m.deviation <= T(most_jitter * most_jitter);
  }

 private:
  static void fade(Memory& m) noexcept {
    const T step = regular(m) ? T(0.02) : T(-0.02), weight = m.weight + step;
    m.weight = weight < T(0) ? T(0) : (weight > T(1) ? T(1) : weight);
  }
  Nanoseconds period_;
  T b0_, b1_, a2_;
};

SKINCTL_END_NAMESPACE
