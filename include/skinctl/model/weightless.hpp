// A robot whose own controller holds gravity, as laws see it.
#pragma once

#include "skinctl/core/triple.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `M` without weight: masses and inertias are its own, gravity is a typed zero. What a robot's own controller
/// holds does not reach the laws: `G(q)` is zero for them, and costs nothing.
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
