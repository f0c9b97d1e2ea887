// Fewer rounds by day: the gate finds what breaks at once, the night what breaks once in ten thousand rounds.
#pragma once

#include "skinctl/testing/sanitized.hpp"

// The scalars of a test of whole scenes. By day a program has one of them: float as users compile it, double
// elsewhere.
#if !defined(SKINCTL_GATE)
#define SKINCTL_SCALARS float, double
#elif defined(SKINCTL_NO_FORCED_INLINE)
#define SKINCTL_SCALARS double
#else
#define SKINCTL_SCALARS float
#endif

// The scalars of a table of extremes: float overflows first.
#if defined(SKINCTL_GATE)
#define SKINCTL_EXTREME_SCALARS float
#else
#define SKINCTL_EXTREME_SCALARS float, double
#endif

namespace skinctl::testing {

#if defined(SKINCTL_GATE)
inline constexpr bool by_day = true;
#else
inline constexpr bool by_day = false;
#endif

/// `by_night` rounds of a loop over random inputs, a tenth of them in the gate.
template <class Count>
[[nodiscard]] constexpr Count rounds(Count by_night) noexcept {
  return by_day ? by_night / 10 : by_night;
}

}  // namespace skinctl::testing
