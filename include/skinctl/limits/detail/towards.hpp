// SPDX-License-Identifier: BSD-3-Clause
// The velocity farthest on the way from one that is allowed to one that is wished.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/math/greatest_share.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The velocity farthest from `allowed` towards `wished` that `keeps(velocity)` allows, to 2^-16 of the way;
/// `allowed` itself is not asked for. 16 calls of `keeps`.
template <std::size_t N, class T, class Keeps>
[[nodiscard]] SKINCTL_INLINE JointVelocity<N, T> towards(const JointVelocity<N, T>& allowed,
                                                         const JointVelocity<N, T>& wished,
                                                         const Keeps& keeps) noexcept {
  constexpr int halvings = 16;  // of a speed limit of 0.25 m/s it leaves 4 um/s
  const auto mixed = [&](const T& part) {
    JointVelocity<N, T> u;
    for (std::size_t i = 0; i < N; ++i) u[i] = allowed[i] + part * (wished[i] - allowed[i]);
    return u;
  };
  const T share = math::greatest_share<halvings, T>([&](const T& part) { return keeps(mixed(part)); });
  return share > T(0) ? mixed(share) : allowed;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
