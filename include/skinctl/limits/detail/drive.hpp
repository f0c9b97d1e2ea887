// SPDX-License-Identifier: BSD-3-Clause
// The joints by torque of a robot, as a governor brakes them.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The motion of the joints of `Set` to which their torques lead in the time `ahead`, while the other joints
/// move as told.
template <class Set, RobotModel M, Real T>
class Drive {
  static constexpr std::size_t N = M::joints, n = Set::count;

 public:
  using Torque = JointTorque<n, T>;
  using Velocity = JointVelocity<n, T>;
  const JointLimits<N, T>& limits;
  const State<N, T>& measured;
  T ahead;                 ///< time of the prediction [s]
  MassMatrix<N, T> mass;   ///< mass matrix of all joints, with their motors
  JointTorque<N, T> bias;  ///< C dq + G of all joints [N m]
  Torque asked;            ///< wished torque of the joints of `Set`, within its limits [N m]

  /// @param motors  their inertia at the joints, which outweighs that of a wrist's links [kg m^2].
  SKINCTL_INLINE Drive(const M& model, const JointTorque<N, T>& motors, const JointLimits<N, T>& given,
                       const State<N, T>& state, const JointTorque<N, T>& wish, const T& time) noexcept
      : limits(given), measured(state), ahead(time), model_(model), angles_(model, state.q) {
    mass = mass_matrix(model_, angles_);
    for (std::size_t i = 0; i < N; ++i) mass(i, i) = mass(i, i) + motors[i];
    bias = bias_torque(model_, angles_, state.dq);
    asked = Set::of(limits.within(wish, state.dq));
  }
  /// Predicts `driven`, the velocities to which the torque beyond `hold` leads, which holds the robot, and
  /// `world`, the change of velocity by `resistance`. Returns false if the mass matrix is not positive
  /// definite.
  [[nodiscard]] SKINCTL_INLINE bool leads(const JointTorque<N, T>& hold, const Torque& resistance,
                                          Velocity& driven, Velocity& world) const noexcept {
    const math::Ldlt<n, T> factors(block_of<Set>(mass).data);
    if (!factors.positive_definite()) return false;
    const auto lead_to = [&](const Velocity& from, const Torque& net) {
      JointAcceleration<n, T> given;
      factors.solve(net.data, given.data);
      return integrate(from, given, ahead);
    };
    Torque net = asked - Set::of(limits.within(hold, measured.dq));
    net -= Set::of(coriolis_torque(model_, angles_, measured.dq));
    driven = lead_to(Set::of(measured.dq), net);
    world = lead_to({}, T(-1) * resistance);
    return true;
  }
  /// The torque that changes the velocities of the joints by `u` in the time `ahead` [N m].
  [[nodiscard]] SKINCTL_INLINE Torque that_takes(const JointVelocity<N, T>& u) const noexcept {
    return momentum_of<Set>(mass, u) * T(T(1) / ahead);
  }
  /// `torque` with `own` for the joints of `Set`, cut to their limits.
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> with(JointTorque<N, T> torque,
                                                      const Torque& own) const noexcept {
    if constexpr (Set::is_all) {
      return limits.within(own, measured.dq);
    } else {
      JointTorque<N, T> all = torque;
      Set::put(own, all);
      Set::put(Set::of(limits.within(all, measured.dq)), torque);
      return torque;
    }
  }

 private:
  const M& model_;
  JointAngles<M, T> angles_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
