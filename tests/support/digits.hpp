// Whether cases in 50 digits are compiled. Under the sanitizers each of them takes minutes, with GCC a third of
// the time of its file, and the same templates run in float and double: as users compile it the gate has them,
// everywhere else the night.
#pragma once

#include "skinctl/testing/sanitized.hpp"

#if SKINCTL_SANITIZED || (defined(SKINCTL_GATE) && defined(SKINCTL_NO_FORCED_INLINE))
#define SKINCTL_MANY_DIGITS 0
#else
#define SKINCTL_MANY_DIGITS 1
#endif
