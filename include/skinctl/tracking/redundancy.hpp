// SPDX-License-Identifier: BSD-3-Clause
// Motion of the joints in the null space of operational laws.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The null space comes to rest, as fast as K_d stops it.
struct DampedNullSpace {
  static constexpr bool rests = true;
};

/// The null space is free: this law neither brakes nor drives it, and the skin moves it. (Its motion has no
/// acceleration in `ddq_r`.)
struct FreeNullSpace {
  static constexpr bool rests = false;
};

SKINCTL_END_NAMESPACE
