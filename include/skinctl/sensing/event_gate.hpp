// SPDX-License-Identifier: BSD-3-Clause
// The threshold above which a reading counts as a touch.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Lets readings pass above a threshold and gives 0 below it.
///
/// It opens at `opens_at` and closes below `closes_below` (hysteresis); while open the output is the reading
/// minus `subtract`. With `subtract == opens_at` the output is continuous (a dead band); otherwise it steps
/// by `opens_at - subtract` on opening and by `closes_below - subtract` on closing. Its only state is open or
/// closed: the thresholds are constant and do not adapt to the readings, so a contact held for a day gives
/// the same output at its end.
///
/// A NaN closes it.
template <class T = double>
class EventGate {
 public:
  /// Lets everything above 0 pass.
  constexpr EventGate() noexcept = default;

  /// Throws `ConfigurationError` unless `opens_at >= closes_below >= subtract >= 0`.
  EventGate(T opens_at, T closes_below, T subtract)
      : opens_at_(opens_at), closes_below_(closes_below), subtract_(subtract) {
    require(subtract >= T(0), "EventGate: subtract", double(subtract), ">= 0");
    require(closes_below >= subtract, "EventGate: closes_below", double(closes_below), ">= subtract");
    require(opens_at >= closes_below && double(opens_at) - double(opens_at) == 0, "EventGate: opens_at",
            double(opens_at), ">= closes_below");
  }
  /// A gate that gives 0 below the threshold and the excess above it: continuous, so that it needs no
  /// hysteresis.
  [[nodiscard]] static EventGate dead_band(T threshold) { return EventGate(threshold, threshold, threshold); }
  /// A gate that gives the full reading while open: it steps by the threshold, so it should open and close at
  /// different readings.
  [[nodiscard]] static EventGate hysteresis(T opens_at, T closes_below) {
    return EventGate(opens_at, closes_below, T(0));
  }

  /// The output for the reading `x`; `open` is whether the gate was open for the previous reading.
  [[nodiscard]] SKINCTL_INLINE constexpr T pass(const T& x, bool open) const noexcept {
    return x >= (open ? closes_below_ : opens_at_) && x > subtract_ ? T(x - subtract_) : T(0);
  }

  [[nodiscard]] constexpr T opens_at() const noexcept { return opens_at_; }
  [[nodiscard]] constexpr T closes_below() const noexcept { return closes_below_; }
  [[nodiscard]] constexpr T subtract() const noexcept { return subtract_; }

  /// The same gate for integer readings in steps of `unit`; thresholds are rounded to the nearest step.
  [[nodiscard]] EventGate<std::int32_t> counted(double unit) const {
    require(unit > 0, "EventGate: unit", unit, "> 0");
    const auto steps = [unit](T x) {
      const double n = std::round(double(x) / unit);
      require(n < 2147483647.0, "EventGate: threshold", double(x), "less than 2^31 steps");
      return static_cast<std::int32_t>(n);
    };
    return EventGate<std::int32_t>(steps(opens_at_), steps(closes_below_), steps(subtract_));
  }

 private:
  T opens_at_{0}, closes_below_{0}, subtract_{0};  // [unit of the reading]
};

SKINCTL_END_NAMESPACE
