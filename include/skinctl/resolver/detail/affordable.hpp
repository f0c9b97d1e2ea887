// SPDX-License-Identifier: BSD-3-Clause
// The velocity that a passivity observer can pay for.
#pragma once

#include "skinctl/math/greatest_share.hpp"
#include "skinctl/passivity/passivity_observer.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Slows `v` down to the velocity that `observer` can pay for, braking included, its part out of contacts
/// last. `reach(u)` is the displacement from the measured position to where a robot that moves at `u` comes
/// to rest. Returns false if `v` was slowed.
template <std::size_t N, Real T, class Memory, class Reach>
SKINCTL_INLINE bool slow_to_afford(const PassivityObserver<T>& observer, const Memory& memory,
                                   JointVelocity<N, T>& v, const Reach& reach) noexcept {
  using Velocity = JointVelocity<N, T>;
  const auto allows = [&](const Velocity& u) { return observer.allows(memory, reach(u), u); };
  if (allows(v)) [[likely]]
    return true;
  // What leads out of the contacts, as far as it is allowed; then as much of the rest as can be paid for.
  const Velocity out = observer.outward(memory, v);
  const auto most = [&](const Velocity& base, const Velocity& more) {
    constexpr int halvings = 10;  // a share is known to 2^-10
    return base +
           math::greatest_share<halvings, T>([&](const T& s) { return allows(base + s * more); }) * more;
  };
  v = allows(out) ? most(out, v - out) : most(Velocity{}, out);
  return false;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
