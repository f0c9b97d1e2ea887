// SPDX-License-Identifier: BSD-3-Clause
// A yes-or-no feature of a signal: two thresholds, and two debounce times in continuous time.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A bit that rises when its signal has been at or above `on` for `on_after`, and falls when the signal has
/// been below `off` for `off_after`.
///
/// The signal is taken as linear between its samples, so times do not depend on the rate: the instant at
/// which it crosses a threshold is interpolated, and is the stamp of the event. A signal that returns through
/// its threshold before the debounce time is over has not crossed it.
///
/// The bit flips with the first sample at or after the end of the debounce time. Two flips fit between two
/// samples: up and down again.
template <Real T = double>
class Bit {
 public:
  struct Settings {
    T on{}, off{};  ///< thresholds of the rise and of the fall, `off <= on`, in the signal's unit
    Nanoseconds on_after{}, off_after{};
  };
  /// Trivially copyable; `Memory{}` is down and has seen no sample.
  struct Memory {
    Nanoseconds time{};     ///< time of the newest sample
    Nanoseconds since{};    ///< time at which the signal crossed the threshold to the value `on` has
    Nanoseconds crossed{};  ///< time at which the signal crossed the threshold of a flip that is `pending`
    T value{};              ///< value of the newest sample
    bool on = false;
    bool pending = false;
    bool started = false;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit Bit(const Settings& s) : s_(s) {
    require(s.on - s.on == T(0) && s.off <= s.on, "Bit: off", static_cast<double>(s.off),
            "<= on, both finite");
    require(s.off - s.off == T(0), "Bit: off", static_cast<double>(s.off), "finite");
    require(s.on_after >= 0ns && s.on_after <= 10s, "Bit: on_after", milliseconds(s.on_after), "0 to 1e4 ms");
    require(s.off_after >= 0ns && s.off_after <= 10s, "Bit: off_after", milliseconds(s.off_after),
            "0 to 1e4 ms");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes a sample. The first one counts as if the signal had just reached it. A sample that is not finite
  /// (`sample_not_finite`) or older than the last one (`time_backwards`) is ignored. Of two samples with one
  /// stamp the second is a step of the signal.
  Status step(Memory& m, Nanoseconds time, const T& x) const noexcept {
    if (!(x - x == T(0))) return Reason::sample_not_finite;
    if (m.started && time < m.time) return Reason::time_backwards;
    if (!m.started) {
      m.started = true;
      m.since = m.time = time;
      m.value = x;
      m.pending = x >= s_.on;
      m.crossed = time;
    }
    // At most up and down again within one stretch of a line.
    for (int flips = 0; flips < 2; ++flips) {
      const bool before = away(m.on, m.value), after = away(m.on, x);
      if (!before && after) {
        m.crossed = crossing(m, time, x);
        m.pending = true;
      }
      const Nanoseconds held_until = before && !after ? crossing(m, time, x) : time;
      const bool flips_now = m.pending && held_until - m.crossed >= (m.on ? s_.off_after : s_.on_after);
      if (!after) m.pending = false;
      if (!flips_now) break;
      m.on = !m.on;
      m.since = m.crossed;
      m.pending = false;
    }
    m.time = time;
    m.value = x;
    return {};
  }
  /// Sets the bit to `on` from `time` on, and forgets the samples before.
  static void set(Memory& m, bool on, Nanoseconds time) noexcept {
    m = Memory{};
    m.on = on;
    m.since = time;
  }

 private:
  /// Whether `x` is on the other side of the threshold that ends the present value `on`.
  [[nodiscard]] bool away(bool on, const T& x) const noexcept { return on ? x < s_.off : x >= s_.on; }
  [[nodiscard]] Nanoseconds crossing(const Memory& m, Nanoseconds time, const T& x) const noexcept {
    const T rise = x - m.value, share = rise == T(0) ? T(0) : T(((m.on ? s_.off : s_.on) - m.value) / rise);
    const double within = share > T(0) ? (share < T(1) ? static_cast<double>(share) : 1.0) : 0.0;
    return m.time +
           Nanoseconds(static_cast<std::int64_t>(within * static_cast<double>((time - m.time).count())));
  }

  Settings s_;
};

SKINCTL_END_NAMESPACE
