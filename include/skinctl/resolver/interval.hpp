// SPDX-License-Identifier: BSD-3-Clause
// The interval that one cycle integrates.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The interval that a cycle integrates: `(from, to]` in equal sub-steps.
struct Interval {
  Nanoseconds from{};
  Nanoseconds to{};
  unsigned substeps = 0;
  Status status;
  /// Time of the cycle, `to` unless the clock went back.
  Nanoseconds seen{};
  /// Whether the clock had leapt and is back: stamps are to be moved by `from` minus the last cycle's time.
  bool clock_set = false;
  /// Time by which earlier cycles came too soon, up to a period: left to the servo for this command.
  Nanoseconds carried{};

  /// The time in which a robot with this period carries the cycle's command out: at most a period, however
  /// late the cycle is.
  [[nodiscard]] constexpr Nanoseconds command_duration(Nanoseconds period) const noexcept {
    const Nanoseconds all = to - from + carried;
    return all < period ? all : period;
  }

  /// Begin of sub-step `j`; `at(substeps)` is the end.
  [[nodiscard]] constexpr Nanoseconds at(unsigned j) const noexcept {
    if (j >= substeps) return to;  // most cycles have few sub-steps: without the divisions
    if (j == 0) return from;
    return from + (to - from) / substeps * j + (to - from) % substeps * j / substeps;
  }
};

namespace detail {

/// The time in place of a refused one: the clock has not gone back.
inline constexpr Nanoseconds no_time = Nanoseconds::min();

/// The interval from `last` to `now`, sub-steps not yet chosen. A clock that goes back is not believed once,
/// but twice: a time that follows `odd`, the refused time of the cycle before, is that of a clock that leapt
/// and is back, and the interval begins at `odd`. So one stamp far in the future costs two cycles.
[[nodiscard]] SKINCTL_INLINE Interval interval_since(bool started, Nanoseconds last, Nanoseconds odd,
                                                     Nanoseconds now, Nanoseconds longest) noexcept {
  if (!started) return {0ns, 0ns, 0, Reason::interval_empty, now};
  if (now == last) return {last, last, 0, Reason::interval_empty, now};
  if (now < last || !is_plausible(now)) [[unlikely]] {
    if (is_plausible(now) && odd != no_time && odd < now && now - odd <= longest)
      return {odd, now, 0, {}, now, true};
    return {last, last, 0, Reason::time_backwards, now};
  }
  if (now - last > longest) return {now - longest, now, 0, Reason::interval_too_long, now};
  return {last, now, 0, {}, now};
}
/// The time that a cycle without an interval remembers: its own where the clock went back, else `no_time`.
[[nodiscard]] SKINCTL_INLINE Nanoseconds odd_time_of(const Interval& interval) noexcept {
  return interval.status.has(Reason::time_backwards) && is_plausible(interval.seen) ? interval.seen : no_time;
}

/// Counts in `in_a_row` the intervals below a hundredth of the period; from a hundred in a row on
/// `interval_too_short`: the clock counts in another unit (microseconds, milliseconds), or hardly runs.
[[nodiscard]] SKINCTL_INLINE Status note_length(std::uint8_t& in_a_row, const Interval& interval,
                                                Nanoseconds period) noexcept {
  constexpr int per_period = 100;       // jitter is longer, a clock in another unit 1000 times shorter
  constexpr std::uint8_t enough = 100;  // cycles that catch up come a few at a time
  constexpr auto last = std::numeric_limits<std::uint8_t>::max();
  const bool is_short = (interval.to - interval.from) * per_period < period;
  in_a_row = is_short ? static_cast<std::uint8_t>(in_a_row + (in_a_row < last)) : std::uint8_t(0);
  return in_a_row >= enough ? Status(Reason::interval_too_short) : Status{};
}

}  // namespace detail
SKINCTL_END_NAMESPACE
