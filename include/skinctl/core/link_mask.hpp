// SPDX-License-Identifier: BSD-3-Clause
// A set of links, known at compile time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A set of links, bit `i` for link `i`.
using LinkMask = std::uint64_t;

/// The mask that holds link `Ix` only.
template <std::size_t Ix>
inline constexpr LinkMask link_bit = LinkMask(1) << Ix;

SKINCTL_END_NAMESPACE
