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

  /// Begin of sub-step `j`; `at(substeps)` is the end.
  [[nodiscard]] constexpr Nanoseconds at(unsigned j) const noexcept {
    return substeps == 0 ? to : from + (to - from) / substeps * j + (to - from) % substeps * j / substeps;
  }
};

namespace detail {

/// The interval from `last` to `now`, sub-steps not yet chosen.
[[nodiscard]] SKINCTL_INLINE Interval interval_since(bool started, Nanoseconds last, Nanoseconds now,
                                                     Nanoseconds longest) noexcept {
  if (!started) return {0ns, 0ns, 0, Reason::interval_empty};
  if (now == last) return {last, last, 0, Reason::interval_empty};
  if (now < last || !is_plausible(now)) return {last, last, 0, Reason::time_backwards};
  if (now - last > longest) return {now - longest, now, 0, Reason::interval_too_long};
  return {last, now, 0, {}};
}

}  // namespace detail
SKINCTL_END_NAMESPACE
