// Motion of the joints in the null space of operational laws.
#pragma once

#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A joint motion; the law uses its part in the null space of the tool.
template <std::size_t N, Scalar T = double>
struct NullMotion {
  JointVelocity<N, T> v;
  JointAcceleration<N, T> a;
};

/// The null space comes to rest, as fast as K_d stops it.
struct DampedNullSpace {
  static constexpr bool rests = true;
};

/// The null space is free: this law neither brakes nor drives it, and the skin moves it. (Its motion has no
/// acceleration in `ddq_r`.)
struct FreeNullSpace {
  static constexpr bool rests = false;
  template <std::size_t N, Real T>
  [[nodiscard]] NullMotion<N, T> motion(const JointPosition<N, T>&,
                                        const JointVelocity<N, T>& dq) const noexcept {
    return {dq, {}};
  }
};

SKINCTL_END_NAMESPACE
