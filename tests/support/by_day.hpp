// Fewer rounds by day: the gate finds what breaks at once, the night what breaks once in ten thousand rounds.
#pragma once

#include "skinctl/testing/sanitized.hpp"

// The scalars of a test that the gate compiles twice: as users do, in both, and with the sanitizers' checks,
// in one.
#if defined(SKINCTL_GATE) && SKINCTL_SANITIZED
#define SKINCTL_SCALARS double
#else
#define SKINCTL_SCALARS float, double
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
