// SPDX-License-Identifier: BSD-3-Clause
// Numbers that several parts of a tracking law share.
#pragma once

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Speed below which a goal or a reference stands [rad/s, m/s]: a millimetre a second.
inline constexpr double standing_speed = 1e-3;
/// Magnitude below which a decaying motion is zero: long before its denormal numbers, which are slow.
inline constexpr double smallest_motion = 1e-30;

}  // namespace detail
SKINCTL_END_NAMESPACE
