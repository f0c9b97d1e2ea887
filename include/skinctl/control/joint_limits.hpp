// SPDX-License-Identifier: BSD-3-Clause
// A law that keeps the joints away from the ends of their range.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of `JointLimitLaw`.
template <std::size_t N, Real T = double>
struct JointLimitSettings {
  JointPosition<N, T> lower = JointPosition<N, T>::constant(T(-6.2831853));  ///< lower position limit [rad]
  JointPosition<N, T> upper = JointPosition<N, T>::constant(T(6.2831853));   ///< upper position limit [rad]
  T margin = T(0.2);  ///< width of the zone before a limit in which the law acts [rad]
  JointTorque<N, T> strength = JointTorque<N, T>::constant(T(20));  ///< repelling torque at the limit [N m]
  JointTorque<N, T> damping = JointTorque<N, T>::constant(T(5));    ///< damping at the limit [N m s/rad]
};

/// Repels from the limits: with x the depth in the margin, in margins (1 at the limit, and growing beyond),
/// `tau = -+ strength x^2 - damping x^2 / (1 + x^2) 2 dq`. Zero outside of the margins, continuous with its
/// first derivative, and passive: the spring's potential is `strength margin x^3 / 3`. Beyond three margins
/// it is constant. Its weight in a sum is not normalised.
template <std::size_t N, Real T = double>
class JointLimitLaw : public StatelessLaw<JointLimitLaw<N, T>> {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  static constexpr const char* name = "joint_limits";

  /// Throws `ConfigurationError` for a range no wider than its margins, and for negative numbers.
  explicit JointLimitLaw(const JointLimitSettings<N, T>& settings = {}) : settings_(settings) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(settings.margin > T(0) && settings.margin <= T(10), "margin of joint limits",
            number(settings.margin), "> 0 rad");
    for (std::size_t i = 0; i < N; ++i) {
      const T range = settings.upper[i] - settings.lower[i];
      require(range > T(2) * settings.margin, "range between joint limits", number(range),
              "more than two margins");
      require(settings.strength[i] >= T(0) && settings.strength[i] <= T(1e6), "strength",
              number(settings.strength[i]), ">= 0 N m");
      require(settings.damping[i] >= T(0) && settings.damping[i] <= T(1e6), "damping",
              number(settings.damping[i]), ">= 0 N m s/rad");
    }
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const K& known) const noexcept {
    JointTorque<N, T> tau;
    for (std::size_t i = 0; i < N; ++i) {
      const T above = (known.q()[i] - settings_.upper[i]) / settings_.margin + T(1);
      const T below = (settings_.lower[i] - known.q()[i]) / settings_.margin + T(1);
      const bool up = above > below;
      T x = up ? above : below;
      if (!(x > T(0))) continue;
      if (x > T(3)) x = T(3);
      const T square = x * x;
      tau[i] = (up ? T(-settings_.strength[i]) : settings_.strength[i]) * square -
               T(2) * settings_.damping[i] * square / (T(1) + square) * known.dq()[i];
    }
    return tau;
  }

 private:
  JointLimitSettings<N, T> settings_;
};

SKINCTL_END_NAMESPACE
