// SPDX-License-Identifier: BSD-3-Clause
// A low-pass filter of first order for samples that come when they like.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The low-pass filter of first order `tau y' = x - y`, exact for an input x that is linear between its
/// samples x0 and x1, whatever their distance dt:
///
///     u = dt / tau,  E = exp(-u),  g = (1 - E) / u:   y <- E y + (g - E) x0 + (1 - g) x1
///
/// so the output does not depend on the rate. A sensor that sends only changes calls `event`: its input was
/// constant until `ramp` before the new sample, and linear from there.
///
/// The first sample sets the output. A sample that is not finite (`sample_not_finite`) or not later than the
/// last one (`time_backwards`) is ignored.
template <Real T = double>
class LowPass {
 public:
  /// Trivially copyable; `Memory{}` has no sample.
  struct Memory {
    Nanoseconds time{};
    T input{}, output{};
    bool started = false;
  };

  /// Throws `ConfigurationError` unless `tau` and `ramp` are in (0, 1000] s.
  explicit LowPass(Nanoseconds tau, Nanoseconds ramp = 6ms) : tau_(seconds<T>(tau)), ramp_(ramp) {
    require(tau > 0ns && tau <= 1000s, "LowPass: tau", milliseconds(tau), "> 0, <= 1e6 ms");
    require(ramp > 0ns && ramp <= 1000s, "LowPass: ramp", milliseconds(ramp), "> 0, <= 1e6 ms");
  }

  /// Takes a sample of an input that is linear since the last one.
  Status sample(Memory& m, Nanoseconds time, const T& x) const noexcept {
    const Status status = look(m, time, x);
    if (!status.any() && m.started) m.output = after(m, distance(m.time, time), x);
    if (!status.any()) m = {time, x, m.started ? m.output : x, true};
    return status;
  }
  /// Takes a sample of an input that was constant since the last one but for the last `ramp`.
  Status event(Memory& m, Nanoseconds time, const T& x) const noexcept {
    const Status status = look(m, time, x);
    if (status.any() || !m.started) return sample(m, time, x);
    if (distance(m.time, time) > seconds<T>(ramp_)) static_cast<void>(sample(m, time - ramp_, T(m.input)));
    return sample(m, time, x);
  }
  /// The output at `time`, the input being constant since its last sample; at or before that sample, the
  /// output there.
  [[nodiscard]] T value(const Memory& m, Nanoseconds time) const noexcept {
    return m.started && time > m.time ? after(m, distance(m.time, time), m.input) : m.output;
  }

 private:
  static Status look(const Memory& m, Nanoseconds time, const T& x) noexcept {
    if (!(x - x == T(0))) return Reason::sample_not_finite;
    if (m.started && time <= m.time) return Reason::time_backwards;
    return {};
  }
  /// `to - from` > 0 in seconds, which never overflows.
  static T distance(Nanoseconds from, Nanoseconds to) noexcept {
    const auto ns = static_cast<std::uint64_t>(to.count()) - static_cast<std::uint64_t>(from.count());
    return static_cast<T>(static_cast<double>(ns) * 1e-9);
  }
  T after(const Memory& m, const T& dt, const T& x) const noexcept {
    using std::expm1;
    const T u = dt / tau_, gone = -expm1(-u);  // 1 - E
    return m.output + gone * (m.input - m.output) + lag(u, gone) * (x - m.input);
  }
  /// `1 - g`, without cancellation where u is small: the series `u/2! - u^2/3! + ...`.
  static T lag(const T& u, const T& gone) noexcept {
    if (u > T(0.5)) return T(1) - gone / u;
    T term = u / T(2), sum = term;
    for (int k = 3; k <= 17; ++k) {
      term = -term * u / T(k);
      sum = sum + term;
    }
    return sum;
  }

  T tau_;
  Nanoseconds ramp_;
};

SKINCTL_END_NAMESPACE
