// SPDX-License-Identifier: BSD-3-Clause
// The greatest share of a motion that a condition allows, in a bounded number of questions.
#pragma once

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The greatest share in [0, 1), in steps of 2^-`halvings`, for which `keeps(share)` holds, if that holds
/// for all smaller ones. 0 is not asked for, and returned where nothing else holds. `halvings` calls.
template <int halvings, class T, class Keeps>
[[nodiscard]] SKINCTL_INLINE T greatest_share(const Keeps& keeps) noexcept {
  T share(0), part(0.5);
  for (int k = 0; k < halvings; ++k, part = T(0.5) * part)
    if (keeps(T(share + part))) share = share + part;
  return share;
}

}  // namespace math
SKINCTL_END_NAMESPACE
