// SPDX-License-Identifier: BSD-3-Clause
// Motion of the joints in the null space of operational laws.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The joints' motion in the tool's null space comes to rest, as fast as the damping K_d stops it.
struct DampedNullSpace {
  static constexpr bool rests = true;
};

/// The joints' motion in the tool's null space is free: this law neither brakes nor drives it, and the skin
/// moves it. (It has no acceleration in `ddq_r`.)
struct FreeNullSpace {
  static constexpr bool rests = false;
};

SKINCTL_END_NAMESPACE
