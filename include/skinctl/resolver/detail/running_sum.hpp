// SPDX-License-Identifier: BSD-3-Clause
// A sum whose rounding errors are kept beside it.
#pragma once

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/math/sum.hpp"

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
    math::add_compensated(value[i], rest[i], step);
  }
  /// Adds a step of all joints.
  SKINCTL_INLINE void add(const Row<N, T>& step) noexcept {
    Row<N, T> sum(value), left(rest);
    Row<N, T>::each_block([&](auto k) SKINCTL_INLINE_LAMBDA {
      math::add_compensated(sum.block[k], left.block[k], step.block[k]);
    });
    sum.store(value);
    left.store(rest);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
