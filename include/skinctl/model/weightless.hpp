// SPDX-License-Identifier: BSD-3-Clause
// The model that laws use where the robot's own controller compensates gravity.
#pragma once

#include "skinctl/core/triple.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `M` without weight: masses and inertias are its own, gravity is a typed zero. For laws `G(q)` is then zero
/// and costs nothing.
template <RobotModel M>
class Weightless : public M {
 public:
  explicit constexpr Weightless(const M& model) : M(model) {}

  template <Scalar T>
  static SKINCTL_INLINE constexpr auto gravity() noexcept {
    return ZeroTriple{};
  }
};

SKINCTL_END_NAMESPACE
