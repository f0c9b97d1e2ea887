// Limits of position and speed for a robot that takes torques.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Position and velocity limits of the joints of a robot by torque, as a part of a governor; a scene by
/// torque has them unless it is built without.
///
/// The motion of such a robot is not commanded, so the limits act on the velocity to which the torque leads
/// in a few cycles, `u = dq + t M^-1 (tau - hold - C dq)`. Each joint's u is kept below its velocity limit and below
/// the speed from which its acceleration limit stops it before its end, by the torque `-M (u - u_kept) / t`.
/// Beyond an end, and above the limit, a joint is only braked. External forces beyond the joints' torques
/// prevail.
template <RobotModel M, Real T = double>
class MotionLimits {
 public:
  static constexpr std::size_t joints = M::joints;
  using MotionPart = void;

  explicit MotionLimits(const M& model) : model_(model) {}
  [[nodiscard]] const M& model() const noexcept { return model_; }

  /// The velocity nearest to `u` that each joint at `q` may have `ahead` seconds from now, and the limits
  /// that acted.
  [[nodiscard]] SKINCTL_INLINE JointVelocity<joints, T> within(const JointLimits<joints, T>& limits,
                                                               const JointPosition<joints, T>& q,
                                                               const JointVelocity<joints, T>& u,
                                                               const T& ahead,
                                                               Status& status) const noexcept {
    const auto room = limits.room(q);
    JointVelocity<joints, T> kept;
    for (std::size_t i = 0; i < joints; ++i) {
      const T V = limits.velocity()[i], a = limits.acceleration()[i];
      // The velocity follows with a lag of `ahead`: four times that as reaction comes to rest without overshoot.
      const T reaction = T(4) * ahead, above = speed_to_stop(room.above[i], reaction, a),
              below = speed_to_stop(room.below[i], reaction, a);
      const T up = above < V ? above : V, down = below < V ? below : V;
      kept[i] = detail::clamp(u[i], T(-down), up);
      if (kept[i] == u[i]) continue;
      const bool by_position = u[i] > T(0) ? above < V : below < V;
      status |= by_position ? Reason::position_limited : Reason::velocity_limited;
    }
    return kept;
  }

 private:
  [[no_unique_address]] M model_;
};

SKINCTL_END_NAMESPACE
