// A sum whose rounding errors are kept beside it.
#pragma once

#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Joint positions as `value + rest`: adding steps of 1e-9 for a day loses nothing, in float either.
template <std::size_t N, Real T>
struct RunningPosition {
  JointPosition<N, T> value;
  JointPosition<N, T> rest;

  SKINCTL_INLINE void set(std::size_t i, const T& x) noexcept {
    value[i] = x;
    rest[i] = T(0);
  }
  SKINCTL_INLINE void add(std::size_t i, const T& step) noexcept {
    const T y = step + rest[i], x = value[i];
    const T sum = x + y, seen = sum - x;
    value[i] = sum;
    rest[i] = (x - (sum - seen)) + (y - seen);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
