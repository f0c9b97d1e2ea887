// SPDX-License-Identifier: BSD-3-Clause
// Friction compensation: the robot moves as if its joints had less friction.
#pragma once

#include "skinctl/dynamics/friction.hpp"
#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `tau = share tau_f(dq)`, the torque that the friction model takes from the moving joints. For a robot by
/// torque whose own controller does not do so (`RobotCompensatesFriction`).
///
/// More compensation than friction would drive the joints, so `share` below 1 leaves a margin for the errors
/// of the model. Below the model's `sign_velocity` the compensation is gradual, so that a noisy velocity
/// shakes nothing.
template <std::size_t N, Real T = double>
class FrictionControl : public StatelessLaw<FrictionControl<N, T>> {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  static constexpr const char* name = "friction";
  static constexpr bool compensates_friction = true;

  /// @param share  share of the friction that is compensated, 0 to 1; else throws `ConfigurationError`.
  explicit FrictionControl(const JointFriction<N, T>& friction, const T& share = T(0.8))
      : friction_(friction), share_(share) {
    require(share >= T(0) && share <= T(1), "share of friction", static_cast<double>(share), "0 to 1");
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const K& known) const noexcept {
    return share_ * friction_.torque(known.dq());
  }

 private:
  JointFriction<N, T> friction_;
  T share_;
};

SKINCTL_END_NAMESPACE
