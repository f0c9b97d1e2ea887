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
/// Share of a joint's largest acceleration that plans use: the rest leads it back to its course. With all of
/// it a robot that is off its course cannot catch up, and swings about its goal.
inline constexpr double planned_share = 0.8;

}  // namespace detail
SKINCTL_END_NAMESPACE
