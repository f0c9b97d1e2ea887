// Friction by a torque that is held for a period.
#pragma once

#include "skinctl/dynamics/mass_matrix.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `B dq` for a joint of friction `b` and inertia `own` whose torque is held for `period` seconds. Friction
/// that would stop the joint in less time would shake it: the friction applied is `B / (1 + 3/2 h B/M_ii)`.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T held_friction(const T& b, const T& own, const T& period,
                                             const T& dq) noexcept {
  return own > T(0) ? T(b * own / (own + T(1.5) * period * b) * dq) : T(0);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
