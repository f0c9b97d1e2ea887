// SPDX-License-Identifier: BSD-3-Clause
// Limits of jerk beside those of the joints: braking begins early enough to be smooth.
#pragma once

#include "skinctl/limits/detail/jerk_joint.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The motion of joints over one step within limits of jerk; `velocity` and `acceleration` are those at its
/// end.
template <std::size_t N, Real T = double>
struct SmoothMotion {
  JointPosition<N, T> displacement;
  JointVelocity<N, T> velocity;
  JointAcceleration<N, T> acceleration;
  Status status;
  std::uint64_t braked = 0;  ///< bit i: joint i was slowed because its room was too small
};
/// The interpolation from motion `a` (`share` 0) to `b` (1), without their status: within the limits that
/// both keep, if they begin alike.
template <std::size_t N, Real T>
[[nodiscard]] SmoothMotion<N, T> mixed(const SmoothMotion<N, T>& a, const SmoothMotion<N, T>& b,
                                       const T& share) noexcept {
  SmoothMotion<N, T> out;
  for (std::size_t i = 0; i < N; ++i) {
    out.displacement[i] = a.displacement[i] + share * (b.displacement[i] - a.displacement[i]);
    out.velocity[i] = a.velocity[i] + share * (b.velocity[i] - a.velocity[i]);
    out.acceleration[i] = a.acceleration[i] + share * (b.acceleration[i] - a.acceleration[i]);
  }
  return out;
}

/// The kind of `MaxJerk`, for `Cycle::without`.
struct JerkLimit {};

/// Limits of `N` joints with a limit of jerk; immutable, checked when built.
///
/// From a state that `move` produced no limit of position, velocity, acceleration or jerk is ever crossed,
/// whatever the target and the length of the following steps. One invariant ensures this: the quickest stop
/// from the new state stays between the ends and below the velocity limit. A step towards the target that
/// would break it is mixed with that quickest stop.
///
/// A robot may *start* in a state from which not all can be kept. In the order of their priority:
/// 1. acceleration: never exceeded, as a drive cannot exceed it;
/// 2. position: an end is passed only by a joint that its full deceleration cannot stop;
/// 3. velocity: a joint that is too fast brakes;
/// 4. jerk: exceeded as little as the others need (`jerk_exceeded`);
/// 5. the target.
///
/// Beyond an end only inward motion is allowed. `JointLimits::move` alone is the same without jerk.
template <std::size_t N, Real T = double>
class JerkLimits {
 public:
  using Kind = JerkLimit;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::moves;
  static constexpr bool decides_motion = true;

  /// Throws `ConfigurationError` for a jerk out of its range: > 0, <= 1e9 rad/s^3, and such that the largest
  /// acceleration is reached within 1000 s.
  SKINCTL_COLD JerkLimits(const JointLimits<N, T>& limits, const JointJerk<N, T>& jerk)
      : limits_(limits), jerk_(jerk) {
    for (std::size_t i = 0; i < N; ++i) {
      require(jerk[i] > T(0) && jerk[i] <= T(1e9), "jerk limit", static_cast<double>(jerk[i]),
              "> 0, <= 1e9 rad/s^3");
      require(jerk[i] * T(slowest_rise) >= limits.acceleration()[i], "jerk limit",
              static_cast<double>(jerk[i]), ">= acceleration limit / 1000 s");
      // No state below the velocity limit travels further than this before it is at rest.
      const T V = limits.velocity()[i], A = limits.acceleration()[i];
      far_[i] = T(1 + Joint::rounding_of_ways) *
                (V * A / jerk[i] + detail::Stopping<T>(V, T(0), A, jerk[i]).reach().above);
    }
  }

  [[nodiscard]] const JointLimits<N, T>& joints() const noexcept { return limits_; }
  [[nodiscard]] const JointJerk<N, T>& jerk() const noexcept { return jerk_; }
  /// The limits of the joints of a subset.
  template <class Set>
  [[nodiscard]] SKINCTL_COLD JerkLimits<Set::count, T> set() const {
    return {limits_.template part<Set>(), Set::of(jerk_)};
  }
  /// `jerk_exceeded`, if the acceleration has changed from `before` to `now` in `dt` seconds faster than the
  /// limit allows.
  [[nodiscard]] SKINCTL_INLINE Status exceeded(const JointAcceleration<N, T>& before,
                                               const JointAcceleration<N, T>& now,
                                               const T& dt) const noexcept {
    using R = detail::Row<N, T>;
    const R change = R(now) - before, most = R(jerk_) * R(dt);
    const R rounding = T(16) * std::numeric_limits<T>::epsilon() * R(limits_.acceleration());
    return any(magnitude(change) > most + rounding) ? Status(Reason::jerk_exceeded) : Status();
  }

  /// The velocity that joints reach from `u` while an acceleration `a` in its direction is brought to zero at
  /// the largest jerk J, `u + a |a| / (2 J)`: the velocity that other limits judge.
  [[nodiscard]] SKINCTL_INLINE JointVelocity<N, T> leads_to(const JointVelocity<N, T>& u,
                                                            const JointAcceleration<N, T>& a) const noexcept {
    JointVelocity<N, T> out = u;
    for (std::size_t i = 0; i < N; ++i)
      if (a[i] * u[i] >= T(0)) out[i] += a[i] * (a[i] < T(0) ? -a[i] : a[i]) / (T(2) * jerk_[i]);
    return out;
  }
  /// The velocity `wish` `h` seconds after `u`, for joints that are slowed no faster than they come to rest
  /// without turning back: by `sqrt(2 J |u|)`.
  [[nodiscard]] SKINCTL_COLD JointVelocity<N, T> without_turning_back(const JointVelocity<N, T>& u,
                                                                      const JointVelocity<N, T>& wish,
                                                                      const T& h) const noexcept {
    using std::sqrt;
    JointVelocity<N, T> out = wish;
    for (std::size_t i = 0; i < N; ++i) {
      const T sign = u[i] < T(0) ? T(-1) : T(1), speed = sign * u[i];
      const T slowed = speed - h * T(sqrt(T(2) * jerk_[i] * speed)), least = slowed > T(0) ? slowed : T(0);
      if (speed > T(0) && sign * wish[i] < least) out[i] = sign * least;
    }
    return out;
  }
  /// The distances in which joints rest that move for `h` seconds from the velocity `u0` to `u1`, with the
  /// acceleration `a1` at the end, and then stop [rad].
  [[nodiscard]] SKINCTL_COLD JointPosition<N, T> rest_of(const JointVelocity<N, T>& u0,
                                                         const JointVelocity<N, T>& u1,
                                                         const JointAcceleration<N, T>& a1,
                                                         const T& h) const noexcept {
    JointPosition<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      const T A = limits_.acceleration()[i], a = a1[i] > A ? A : (a1[i] < -A ? T(-A) : a1[i]);
      out[i] = T(0.5) * h * (u0[i] + u1[i]) + detail::Stopping<T>(u1[i], a, A, jerk_[i]).rest();
    }
    return out;
  }
  /// The motion over `h` > 0 seconds from velocity `u0` and acceleration `a0` towards the velocity `target`
  /// at its end. Within `room`, see `JointLimits::room`.
  ///
  /// A moving target is followed without lag; one that steps is overshot, by up to A^2/(2 J), because its
  /// future is unknown. NaN in a target or in `a0` counts as zero.
  [[nodiscard]] SKINCTL_NOINLINE SmoothMotion<N, T> move(const JointRoom<N, T>& room,
                                                         const JointVelocity<N, T>& u0,
                                                         const JointAcceleration<N, T>& a0,
                                                         const JointVelocity<N, T>& target,
                                                         const T& h) const noexcept {
    return each(room, u0, a0, h, [&](const Joint& joint, std::size_t i, const T& u, const T& a) {
      return joint.move(u, a, target[i], h);
    });
  }

  /// The motion over `h` > 0 seconds from `u0` and `a0` towards rest, by the quickest stop and without
  /// overshoot.
  [[nodiscard]] SKINCTL_COLD SmoothMotion<N, T> brake(const JointRoom<N, T>& room,
                                                      const JointVelocity<N, T>& u0,
                                                      const JointAcceleration<N, T>& a0,
                                                      const T& h) const noexcept {
    return each(room, u0, a0, h, [&](const Joint& joint, std::size_t, const T& u, const T& a) {
      return std::pair(Joint::without_dust(detail::Stopping<T>(u, a, joint.A, joint.J).after(h)), Status{});
    });
  }
  /// Changes a motion that these limits made from `u0` and `a0` such that its rest points are inside `leash`,
  /// as far as they allow: a joint whose quickest stop ends beyond comes back as hard as they allow, if
  /// `comes_back`. Returns the joints whose motion it changed.
  ///
  /// @param leash  distances from the beginning of the motion to the leash's ends [rad]; negative beyond.
  [[nodiscard]] SKINCTL_INLINE std::uint64_t hold_back(SmoothMotion<N, T>& motion,
                                                       const JointRoom<N, T>& room,
                                                       const JointRoom<N, T>& leash,
                                                       const JointVelocity<N, T>& u0,
                                                       const JointAcceleration<N, T>& a0, const T& h,
                                                       bool comes_back) const noexcept {
    std::uint64_t cut = 0;
    for (std::size_t i = 0; i < N; ++i) {
      const Joint joint = joint_of(i, room, h);
      const detail::Moved<T> wish{motion.displacement[i], motion.velocity[i], motion.acceleration[i]};
      const auto kept = joint.held_back(wish, u0[i], joint.within_acceleration(a0[i]), h, leash.below[i],
                                        leash.above[i], comes_back);
      if (kept.u == wish.u && kept.a == wish.a) continue;
      cut |= std::uint64_t(1) << i;
      const auto clean = Joint::without_dust(kept);
      motion.displacement[i] = clean.s, motion.velocity[i] = clean.u, motion.acceleration[i] = clean.a;
    }
    return cut;
  }
  /// Changes a motion from `u0` and `a0` such that joints rest before `ends`, whose quickest stop would pass
  /// them: they brake steadily, and jerk gives way (`jerk_exceeded`).
  ///
  /// @param reaction  time for which the speed goes on before it changes [s].
  SKINCTL_INLINE void brake_before(SmoothMotion<N, T>& motion, const JointRoom<N, T>& ends,
                                   const JointVelocity<N, T>& u0, const JointAcceleration<N, T>& a0,
                                   const T& h, const T& reaction) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (ends.above[i] > far_[i] && ends.below[i] > far_[i]) [[likely]]
        continue;
      const Joint joint = joint_of(i, {}, h);
      if (!joint.passes(u0[i], joint.within_acceleration(a0[i]), ends.above[i], ends.below[i])) continue;
      const T left = u0[i] < T(0) ? T(ends.below[i] + reaction * u0[i]) : T(ends.above[i] - reaction * u0[i]);
      const auto m = joint.steady_stop(u0[i], left, h);
      motion.displacement[i] = m.s, motion.velocity[i] = m.u, motion.acceleration[i] = m.a;
      motion.status |= Reason::jerk_exceeded;
    }
  }

 private:
  /// Longest time to the largest acceleration [s]: a jerk that needs longer is in another unit.
  static constexpr double slowest_rise = 1000;

  using Joint = detail::JerkJoint<T>;

  [[nodiscard]] SKINCTL_INLINE Joint joint_of(std::size_t i, const JointRoom<N, T>& room,
                                              const T& h) const noexcept {
    return {limits_.velocity()[i],
            limits_.acceleration()[i],
            jerk_[i],
            room.above[i],
            room.below[i],
            T(far_[i] + limits_.velocity()[i] * h)};
  }
  template <class Way>
  SKINCTL_INLINE SmoothMotion<N, T> each(const JointRoom<N, T>& room, const JointVelocity<N, T>& u0,
                                         const JointAcceleration<N, T>& a0, const T& h,
                                         Way&& way) const noexcept {
    SmoothMotion<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      const Joint joint = joint_of(i, room, h);
      const T given = joint.within_acceleration(a0[i]);
      const auto start = joint.bearable(u0[i], given);
      if (start.a != given || !start.rests) [[unlikely]]
        out.status |= Reason::jerk_exceeded;
      if (!start.rests) [[unlikely]] {
        without_jerk(i, room, u0, h, out);
        continue;
      }
      const auto [moved, status] = way(joint, i, u0[i], start.a);
      out.status |= status;
      if (status.has(Reason::position_limited)) out.braked |= std::uint64_t(1) << i;
      out.displacement[i] = moved.s;
      out.velocity[i] = moved.u;
      out.acceleration[i] = moved.a;
    }
    return out;
  }

  /// Joint `i` as if its jerk had no limit: it brakes as hard as its acceleration limit allows.
  SKINCTL_COLD void without_jerk(std::size_t i, const JointRoom<N, T>& room, const JointVelocity<N, T>& u0,
                                 const T& h, SmoothMotion<N, T>& out) const noexcept {
    const auto hard = limits_.move(room, u0, JointVelocity<N, T>{}, h);
    out.displacement[i] = hard.displacement[i];
    out.velocity[i] = hard.velocity[i];
    out.status |= Reason::position_limited;
    out.braked |= std::uint64_t(1) << i;
    const T u = hard.velocity[i], rest = T(64) * std::numeric_limits<T>::epsilon() * u0[i];
    out.acceleration[i] = u * u <= rest * rest ? T(0) : T((u - u0[i]) / h);
  }

  JointLimits<N, T> limits_;
  JointJerk<N, T> jerk_;
  JointPosition<N, T> far_;
};

/// Part for `Cycle::with`: the largest jerk of each joint [rad/s^3]. It limits the joints' motion and the
/// guard's braking. Gains of a law that follows goals have to fit: `tracking_settings(robot, jerk)`.
template <std::size_t N, Real T = double>
struct MaxJerk {
  using Kind = JerkLimit;
  JointJerk<N, T> jerk;
};
template <std::size_t N, Real T>
MaxJerk(const JointJerk<N, T>&) -> MaxJerk<N, T>;

/// The `JerkLimits` that `max` makes of a robot's joint limits.
template <class M, std::size_t J, Real S, std::size_t N, Real T>
[[nodiscard]] auto part_for(const M&, const JointLimits<J, S>& limits, const MaxJerk<N, T>& max) {
  static_assert(N == J, "MaxJerk: of a robot with another number of joints");
  return JerkLimits<N, T>(limits, max.jerk);
}

SKINCTL_END_NAMESPACE
