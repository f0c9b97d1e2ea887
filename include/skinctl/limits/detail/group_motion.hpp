// SPDX-License-Identifier: BSD-3-Clause
// The motion of one group of joints by position or velocity towards a velocity.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Memory of the last command of a group.
template <std::size_t N, Real T>
struct GroupMotionMemory {
  JointPosition<N, T> position, carry;  ///< the last command's position, and its rounding error [rad], [m]
};

/// A group of N joints that follows a velocity within the limits of its joints, or as its `Mover` decides.
template <std::size_t N, Real T, class Mover>
class GroupMotion {
 public:
  static constexpr bool smooth = !std::is_same_v<Mover, Abrupt>;
  using Memory = GroupMotionMemory<N, T>;
  using Command = JointCommand<N, T>;

  GroupMotion(const JointLimits<N, T>& limits, const Mover& mover) : limits_(limits), mover_(mover) {}

  [[nodiscard]] SKINCTL_INLINE const Mover& mover() const noexcept { return mover_; }
  /// The motion that the mover decides, from `last` towards the velocity `u` in `dt` seconds, where limits
  /// left u of the motion to `command`. A joint that is only slowed rests no further than with that motion,
  /// for whose rest there are reasons that no limit of the scene knows: an end by velocity, the leash. Where
  /// jerk has to give way the joint's ends decide.
  [[nodiscard]] SKINCTL_COLD auto smoothed(const Command& last, const Command& command,
                                           const JointVelocity<N, T>& u, const T& dt) const noexcept {
    const auto room = limits_.room(last.position);
    auto motion = mover_.move(room, last.velocity, last.acceleration, u, dt);
    if (motion.status.has(Reason::jerk_exceeded)) return motion;
    JointRoom<N, T> leash;
    leash.above = leash.below = JointPosition<N, T>::constant(std::numeric_limits<T>::infinity());
    const auto rests = mover_.rest_of(last.velocity, command.velocity, command.acceleration, dt);
    for (std::size_t i = 0; i < N; ++i) {
      const T v = command.velocity[i], slower = v - u[i];
      if (!(slower * v >= T(0)) || magnitude(slower) > magnitude(v)) continue;
      (v < T(0) ? leash.below : leash.above)[i] = v < T(0) ? T(-rests[i]) : rests[i];
    }
    static_cast<void>(mover_.hold_back(motion, room, leash, last.velocity, last.acceleration, dt, false));
    // Limits of jerk reach any slower motion, too, unless the command's own jerk gave way.
    for (std::size_t i = 0; i < N; ++i) {
      const T v = command.velocity[i], faster = magnitude(motion.velocity[i]) - magnitude(v);
      const T rounding = T(16) * std::numeric_limits<T>::epsilon() * limits_.velocity()[i];
      if (!((v - u[i]) * v >= T(0)) || !(faster > rounding) || motion.velocity[i] * v < T(0)) continue;
      motion.displacement[i] = T(0.5) * dt * (last.velocity[i] + v);
      motion.velocity[i] = v, motion.acceleration[i] = command.acceleration[i];
      motion.status |= Reason::jerk_exceeded;
    }
    return motion;
  }
  /// The motion that the mover decides from `last` to rest.
  [[nodiscard]] SKINCTL_INLINE auto stopped(const Command& last, const T& dt) const noexcept {
    return mover_.brake(limits_.room(last.position), last.velocity, last.acceleration, dt);
  }
  /// Follows `motion` from the command `last`; `out` becomes the command at its end.
  template <class Motion>
  SKINCTL_INLINE void follow(Memory& m, const Command& last, const Motion& motion,
                             Command& out) const noexcept {
    make(m, last, motion, out);
    out.acceleration = motion.acceleration;
  }
  /// Moves towards `u` within the limits of the joints alone.
  SKINCTL_INLINE Status move(Memory& m, const Command& last, const JointVelocity<N, T>& u, const T& dt,
                             Command& out) const noexcept {
    const auto motion = limits_.move(limits_.room(last.position), last.velocity, u, dt);
    make(m, last, motion, out);
    for (std::size_t i = 0; i < N; ++i) out.acceleration[i] = (motion.velocity[i] - last.velocity[i]) / dt;
    return motion.status.without(Reason::acceleration_limited);
  }
  /// The status of an acceleration that changed faster from `last` to `command` than the mover allows.
  [[nodiscard]] SKINCTL_INLINE Status exceeded(const Command& last, const Command& command,
                                               const T& dt) const noexcept {
    return mover_.exceeded(last.acceleration, command.acceleration, dt);
  }

 private:
  template <class Motion>
  SKINCTL_INLINE void make(Memory& m, const Command& last, const Motion& motion,
                           Command& out) const noexcept {
    if (!(m.position == last.position)) m.carry = {};
    for (std::size_t i = 0; i < N; ++i) {
      const T q = last.position[i], step = motion.displacement[i] + m.carry[i];
      const T lower = limits_.lower()[i], upper = limits_.upper()[i];
      T next = q + step;
      m.carry[i] = step - (next - q);
      if (next > upper && q <= upper) next = upper, m.carry[i] = T(0);
      if (next < lower && q >= lower) next = lower, m.carry[i] = T(0);
      out.position[i] = m.position[i] = next;
      out.velocity[i] = motion.velocity[i];
    }
  }

  JointLimits<N, T> limits_;
  [[no_unique_address]] Mover mover_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
