// SPDX-License-Identifier: BSD-3-Clause
// How much the inverse of a Jacobian is damped near singularities.
#pragma once

#include <limits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Damping of the inverse near singularities: `l^2 = most^2 (1 - (w / zone)^2)^2` while the manipulability w
/// is below `zone`, else 0. Smooth: l^2 and its slope are zero at the edge of the zone.
template <Real T = double>
class SingularityDamping {
 public:
  /// @param zone  manipulability below which damping sets in, > 0. In units of `manipulability()`; a UR5
  ///              reaches 0.11, and 0.004 is some 5 degrees from a wrist singularity at half of its reach.
  /// @param most  damping l at the singularity, > 0, in units of the singular values of J: no joint speed
  ///              exceeds `1 / (2 most)` times the requested speed of the frame. Throws `ConfigurationError`.
  explicit SingularityDamping(const T& zone = static_cast<T>(0.004), const T& most = static_cast<T>(0.08))
      : zone_(zone), max_(most), max_squared_(most * most) {
    const auto allowed = [](const T& x) { return x > T(0) && x <= (std::numeric_limits<T>::max)(); };
    require(allowed(zone), "SingularityDamping: zone", static_cast<double>(zone), "> 0");
    require(allowed(most), "SingularityDamping: most", static_cast<double>(most), "> 0");
  }
  /// Nearness of a singularity, from 0 (outside the zone) to 1 (at it), from the square of the
  /// manipulability.
  [[nodiscard]] T nearness(const T& w_squared) const noexcept {
    const T r = T(1) - w_squared / (zone_ * zone_);
    return r > T(0) ? T(r * r) : T(r == r ? T(0) : r);
  }
  /// A damping in the same zone, as large as the requested speed of the frame needs: at the singularity
  /// `l^2 = least^2 + x / (1 + x / most^2)`, `x = (speed / (2 fastest))^2`. No joint exceeds
  /// `fastest sqrt(1 + x / most^2)`: about `fastest` while the request is slow. From `speed = 2 most fastest`
  /// on, where l^2 is half of `most^2` more than `least^2`, it grows with the request; l stays below
  /// `sqrt(least^2 + most^2)`. A small requested speed is damped little, so an arm does not stick at a
  /// singularity.
  /// @param speed_squared, rate  square of the requested velocity of the frame [m^2/s^2 + rad^2/s^2], and its
  ///                             time derivative.
  /// @param fastest  speed limit of the joints [rad/s].
  [[nodiscard]] SingularityDamping scaled(const T& least, const T& speed_squared, const T& rate,
                                          const T& fastest) const noexcept {
    const T factor = T(0.25) / (fastest * fastest);
    const T less = T(1) / (T(1) + factor * speed_squared / (max_ * max_));
    SingularityDamping next = *this;
    next.max_squared_ = least * least + factor * speed_squared * less;
    next.max_squared_rate_ = factor * rate * less * less;
    return next;
  }
  /// The square of the damping, l^2, from the square of the manipulability.
  [[nodiscard]] T squared(const T& w_squared) const noexcept { return max_squared_ * nearness(w_squared); }
  /// The rate of the square of the damping, `d(l^2)/dt = 2 l dl`, from the rate of the square of the
  /// manipulability.
  [[nodiscard]] T squared_rate(const T& w_squared, const T& w_squared_rate) const noexcept {
    const T r = T(1) - w_squared / (zone_ * zone_);
    return r > T(0) ? T(r * (r * max_squared_rate_ - T(2) * max_squared_ * w_squared_rate / (zone_ * zone_)))
                    : T(0);
  }

 private:
  T zone_;
  T max_;
  T max_squared_;
  T max_squared_rate_ = T(0);
};

SKINCTL_END_NAMESPACE
