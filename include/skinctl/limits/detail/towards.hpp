// The velocity farthest on the way from one that is allowed to one that is wished.
#pragma once

#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The velocity farthest from `allowed` towards `wished` that `keeps(velocity)` allows, to 2^-16 of the way;
/// `allowed` itself is not asked for. Time is bounded: 16 questions.
template <std::size_t N, class T, class Keeps>
[[nodiscard]] SKINCTL_INLINE JointVelocity<N, T> towards(const JointVelocity<N, T>& allowed,
                                                         const JointVelocity<N, T>& wished,
                                                         const Keeps& keeps) noexcept {
  T good(0), bad(1);
  JointVelocity<N, T> out = allowed;
  for (int k = 0; k < 16; ++k) {
    const T part = T(0.5) * (good + bad);
    JointVelocity<N, T> u;
    for (std::size_t i = 0; i < N; ++i) u[i] = allowed[i] + part * (wished[i] - allowed[i]);
    const bool may = keeps(u);
    if (may) out = u;
    (may ? good : bad) = part;
  }
  return out;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
