// Takes single wrong samples out of a signal.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Hampel's filter over three samples, at any distances. The middle one passes to the bit unless it is further from
/// the median m of the three than `times max(1.4826 d, sigma)`, d being the median of the distances from m; then the
/// line between its neighbours, at its time, replaces it. So a single peak goes, edges and ramps stay, and the output is
/// one sample late.
///
/// A sample that is not finite (`sample_not_finite`) or not later than the last one (`time_backwards`) is ignored.
template <Real T = double>
class Hampel {
 public:
  /// Trivially copyable; `Memory{}` has no sample.
  struct Memory {
    Nanoseconds time[2] = {};  ///< of the last two, the newest last
    T value[2] = {};
    unsigned count = 0;
  };
  /// The sample before the one that was taken.
  struct Output {
    Nanoseconds time{};
    T value{};
    bool valid = false;     ///< false: there is none yet
    bool replaced = false;  ///< it was a peak
    Status status;          ///< of the sample that was taken
  };

  /// Throws `ConfigurationError` unless `sigma` > 0 and `times` in [1, 100].
  /// @param sigma  standard deviation of the noise, see `cell_noise`.
  explicit Hampel(const T& sigma, const T& times = T(3)) : least_(times * sigma), times_(times * T(1.4826)) {
    require(sigma > T(0) && sigma <= T(1e9), "Hampel: sigma", static_cast<double>(sigma), "> 0, <= 1e9");
    require(times >= T(1) && times <= T(100), "Hampel: times", static_cast<double>(times), "1 to 100");
  }

  Output take(Memory& m, Nanoseconds time, const T& x) const noexcept {
    Output out;
    if (!(x - x == T(0))) {
      out.status = Reason::sample_not_finite;
      return out;
    }
    if (m.count > 0 && time <= m.time[1]) {
      out.status = Reason::time_backwards;
      return out;
    }
    if (m.count > 0) out = {m.time[1], m.value[1], true, false, {}};
    if (m.count > 1) judge(m, time, x, out);
    m.time[0] = m.time[1], m.value[0] = m.value[1];
    m.time[1] = time, m.value[1] = x;
    if (m.count < 2) ++m.count;
    return out;
  }

 private:
  static double between(Nanoseconds from, Nanoseconds to) noexcept {
    return static_cast<double>(static_cast<std::uint64_t>(to.count()) -
                               static_cast<std::uint64_t>(from.count()));
  }
  void judge(const Memory& m, Nanoseconds time, const T& x, Output& out) const noexcept {
    const T a = m.value[0], b = m.value[1];
    // If the middle one is not the median, the nearer of its neighbours is; their distance is d or more than d.
    const T low = a < x ? a : x, high = a < x ? x : a;
    const T median = b < low ? low : (b > high ? high : b);
    const T far = b < median ? T(median - b) : T(b - median), apart = high - low;
    const T d = apart < far ? apart : far;
    const T scale = times_ * d;
    if (!(far > (scale > least_ ? scale : least_))) return;
    out.value = a + static_cast<T>(between(m.time[0], m.time[1]) / between(m.time[0], time)) * (x - a);
    out.replaced = true;
  }
  T least_, times_;
};

SKINCTL_END_NAMESPACE
