// SPDX-License-Identifier: BSD-3-Clause
// Bounds of a point's motion from that of its joints, of both kinds.
#pragma once

#include "skinctl/core/real.hpp"
#include "skinctl/model/topology.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Sums of the magnitudes of displacements, or speeds, of a robot's joints: radians and metres separately.
///
/// Of a point within `reach` [m] of every axis that turns it, joint i has a column J_i of at most `reach`, or
/// 1 if it slides. Joint j changes that column by at most `reach` if both turn, by 1 if one of them slides,
/// and not at all if both do.
template <Topology M, Real T>
class SummedMotion {
 public:
  /// Adds the magnitude of the displacement or speed `x` of joint `i` [rad], [m], [rad/s], [m/s].
  SKINCTL_INLINE void add(std::size_t i, const T& x) noexcept {
    const T size = x < T(0) ? T(-x) : x;
    if constexpr (any_slides)
      if (M::kinds[i] == JointKind::prismatic) {
        slid_ = slid_ + size;
        return;
      }
    turned_ = turned_ + size;
  }
  [[nodiscard]] SKINCTL_INLINE SummedMotion operator+(const SummedMotion& other) const noexcept {
    SummedMotion out;
    out.turned_ = turned_ + other.turned_;
    if constexpr (any_slides) out.slid_ = slid_ + other.slid_;
    return out;
  }
  /// Upper bound of the point's displacement or speed: `sum |x_i| max |J_i|` [m], [m/s].
  [[nodiscard]] SKINCTL_INLINE T way(const T& reach) const noexcept {
    if constexpr (any_slides) return reach * turned_ + slid_;
    return reach * turned_;
  }
  /// Upper bound of the change of `J x`, x the summed motion, while the joints move by y, the motion `over`:
  /// `sum |x_i| |y_j| max |dJ_i/dq_j|` [m], [m/s].
  [[nodiscard]] SKINCTL_INLINE T bend(const T& reach, const SummedMotion& over) const noexcept {
    if constexpr (any_slides)
      return reach * turned_ * over.turned_ + turned_ * over.slid_ + slid_ * over.turned_;
    return reach * turned_ * over.turned_;
  }
  /// Upper bound of the change of `J x` over this motion itself.
  [[nodiscard]] SKINCTL_INLINE T bend(const T& reach) const noexcept { return bend(reach, *this); }

 private:
  static constexpr bool any_slides = [] {
    for (std::size_t i = 0; i < M::joints; ++i)
      if (M::kinds[i] == JointKind::prismatic) return true;
    return false;
  }();
  T turned_ = T(0), slid_ = T(0);
};

SKINCTL_END_NAMESPACE
