// SPDX-License-Identifier: BSD-3-Clause
// Limits of the joints, and motion within them that always keeps a braking distance.
#pragma once

#include <cmath>
#include <cstdio>
#include <limits>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Largest speed from which a joint that brakes with `deceleration` > 0 after `reaction` >= 0 seconds stops
/// within `distance`: the root of `u^2 / (2 a) + u t = d`. Zero for distances <= 0 and NaN, and where the
/// numbers leave the range of `T` on the way: never more than the root, never NaN.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T speed_to_stop(const T& distance, const T& reaction,
                                             const T& deceleration) noexcept {
  using std::sqrt;
  // Farther than this, twice the distance may overflow: any such speed stops within it.
  const T far = std::numeric_limits<T>::max_exponent10 < 100 ? T(1e18) : T(1e150);
  const T d = distance < far ? distance : far;
  const T square = T(2) * d / deceleration;
  const T time = reaction + sqrt(reaction * reaction + square);
  return distance > T(0) && square >= std::numeric_limits<T>::min() ? T(T(2) * d / time) : T(0);
}

/// The share of the acceleration limit used to plan braking before a position limit; the remainder covers
/// rounding.
template <Real T>
inline const T braking_share = T(1) - T(1024) * std::numeric_limits<T>::epsilon();

/// Distances to the lower and upper position limits [rad]; negative beyond a limit.
template <std::size_t N, Real T = double>
struct JointRoom {
  JointPosition<N, T> below;
  JointPosition<N, T> above;
};

/// The motion of joints over one step: `displacement` and final `velocity`. `status` holds the limits that
/// acted, `braked` (bit i for joint i) the joints that were slowed before a position limit.
template <std::size_t N, Real T = double>
struct JointMotion {
  JointPosition<N, T> displacement;
  JointVelocity<N, T> velocity;
  Status status;
  std::uint64_t braked = 0;
};

/// Limits of `N` joints; immutable, checked at construction.
template <std::size_t N, Real T = double>
class JointLimits {
 public:
  struct Values {
    JointPosition<N, T> lower;             ///< lowest position [rad], [m]; -infinity: no end
    JointPosition<N, T> upper;             ///< highest position [rad], [m], above `lower`; infinity: no end
    JointVelocity<N, T> velocity;          ///< largest speed [rad/s], > 0
    JointAcceleration<N, T> acceleration;  ///< largest acceleration, also for braking [rad/s^2], > 0
    JointTorque<N, T> torque;              ///< largest torque [N m], > 0
    /// Maximum driving power of a joint, `tau dq` [W], > 0; braking is not limited. Infinity by default.
    JointPower<N, T> power = JointPower<N, T>::constant(std::numeric_limits<T>::infinity());
  };

  /// Throws `ConfigurationError` for a number out of its range.
  /// @param robot  see `robot_identity()`.
  SKINCTL_COLD explicit JointLimits(const Values& values, const void* robot = nullptr)
      : values_(values), robot_(robot) {
    const T big = std::numeric_limits<T>::max();
    for (std::size_t i = 0; i < N; ++i) {
      const auto check = [i](bool allowed, const char* what, const T& x, const char* range) {
        char name[64];
        std::snprintf(name, sizeof name, "%s of joint %zu", what, i);
        require(allowed, name, static_cast<double>(x), range);
      };
      check(values.lower[i] < values.upper[i], "lower position limit", values.lower[i],
            "below the upper one");
      check(values.velocity[i] > T(0) && values.velocity[i] <= T(1e3), "velocity limit", values.velocity[i],
            "> 0, <= 1e3 rad/s");
      check(values.acceleration[i] > T(0) && values.acceleration[i] <= T(1e5), "acceleration limit",
            values.acceleration[i], "> 0, <= 1e5 rad/s^2");
      check(values.torque[i] > T(0) && values.torque[i] <= big, "torque limit", values.torque[i],
            "> 0 N m, finite");
      check(values.power[i] > T(0), "power limit", values.power[i], "> 0 W");
      has_power_ = has_power_ || values.power[i] <= big;
      stop_per_square_[i] = T(1) / (T(2) * values.acceleration[i]);
    }
  }

  // clang-format off
  template <std::size_t M, class U>
    requires(M != N)
  JointLimits(const JointLimits<M, U>&) = delete;  // limits of another number of joints than the robot has
  // clang-format on

  [[nodiscard]] SKINCTL_INLINE const JointPosition<N, T>& lower() const noexcept { return values_.lower; }
  [[nodiscard]] SKINCTL_INLINE const JointPosition<N, T>& upper() const noexcept { return values_.upper; }
  [[nodiscard]] SKINCTL_INLINE const JointVelocity<N, T>& velocity() const noexcept {
    return values_.velocity;
  }
  [[nodiscard]] SKINCTL_INLINE const JointAcceleration<N, T>& acceleration() const noexcept {
    return values_.acceleration;
  }
  [[nodiscard]] SKINCTL_INLINE const JointTorque<N, T>& torque() const noexcept { return values_.torque; }
  [[nodiscard]] SKINCTL_INLINE const JointPower<N, T>& power() const noexcept { return values_.power; }
  [[nodiscard]] const Values& values() const noexcept { return values_; }
  /// The description that the limits were taken from, by `limits_of`: the address of its `robot_mark`; else
  /// null.
  [[nodiscard]] const void* robot_identity() const noexcept { return robot_; }
  /// The limits of the joints of a subset.
  template <class Set>
  [[nodiscard]] SKINCTL_COLD JointLimits<Set::count, T> part() const {
    const Values& v = values_;
    return JointLimits<Set::count, T>({Set::of(v.lower), Set::of(v.upper), Set::of(v.velocity),
                                       Set::of(v.acceleration), Set::of(v.torque), Set::of(v.power)});
  }
  /// The distances in which joints stop from the speeds `u` at their acceleration limits, `u^2 / (2 a)`.
  [[nodiscard]] SKINCTL_INLINE detail::Row<N, T> stopping_distance(
      const detail::Row<N, T>& u) const noexcept {
    return u * u * stop_per_square_;
  }

  /// Distances from `q` to the position limits [rad], [m]; < 0 beyond them.
  [[nodiscard]] SKINCTL_INLINE JointRoom<N, T> room(const JointPosition<N, T>& q) const noexcept {
    // In rows: GCC stores a difference of vectors in pieces, and a row that loads several of them waits for
    // the stores.
    const detail::Row<N, T> row = q;
    return {JointPosition<N, T>(row - values_.lower), JointPosition<N, T>(values_.upper - row)};
  }
  /// Whether every joint is within its position limits.
  [[nodiscard]] SKINCTL_INLINE bool hold(const JointPosition<N, T>& q) const noexcept {
    const detail::Row row(q);
    return all((row >= values_.lower) & (row <= values_.upper));
  }

  /// `tau`, limited by torque, and by power at the speeds `dq`.
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> within(const JointTorque<N, T>& tau,
                                                        const JointVelocity<N, T>& dq) const noexcept {
    using R = detail::Row<N, T>;
    const R limit = values_.torque;
    JointTorque<N, T> out(clamp(R(tau), -limit, limit));
    for (std::size_t i = 0; has_power_ && i < N; ++i)
      if (out[i] * dq[i] > values_.power[i]) [[unlikely]]
        out[i] = values_.power[i] / dq[i];
    return out;
  }

  /// `tau` within torque and power along its own direction: `hold + s (tau - hold)`, s in [0, 1] the largest
  /// share for which every joint keeps its limits at the speeds `dq`. The robot then accelerates in the
  /// direction asked for, but less. Limited joint by joint, the torque of a strong joint would throw the
  /// light ones.
  ///
  /// @param hold  the torque of no acceleration [N m]: weight and Coriolis forces. A joint that `hold`
  ///              overloads already is limited by itself, as `within` does. So are all of them where a result
  ///              is not finite.
  [[nodiscard]] SKINCTL_COLD JointTorque<N, T> along(const JointTorque<N, T>& tau,
                                                     const JointTorque<N, T>& hold,
                                                     const JointVelocity<N, T>& dq) const noexcept {
    const JointTorque<N, T> cut = within(tau, dq);
    T share(1);
    for (std::size_t i = 0; i < N; ++i) {
      const T over = tau[i] - cut[i], drive = tau[i] - hold[i], room = cut[i] - hold[i];
      // Within the limits, or `hold` is beyond them on that side.
      if (!(over * room > T(0)) || !(room / drive < share)) continue;
      share = room / drive;
    }
    JointTorque<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      out[i] = hold[i] + share * (tau[i] - hold[i]);
      if (!(out[i] - out[i] == T(0))) return cut;
    }
    return within(out, dq);
  }

  /// The motion over `h` > 0 seconds from velocity `u0` towards velocity `target` that keeps the limits.
  ///
  /// Each joint's velocity changes from `u0` to the new one such that its acceleration never exceeds the
  /// limit, and the new one is small enough to stop within `room` at the acceleration limit, whatever the
  /// lengths of the following steps: from a state that this function left, no position limit is ever crossed.
  /// In order of precedence: acceleration (a command never steps), then room, then velocity, then the target.
  /// So a joint that *starts* too fast to stop brakes at its acceleration limit, and beyond a position limit
  /// only inward motion is possible. A NaN target counts as zero, and so does a resulting speed whose square
  /// would be a denormal number (below 1e-17 rad/s in float, 1e-150 in double): denormals are slow, and occur
  /// in a robot at rest.
  [[nodiscard]] SKINCTL_NOINLINE JointMotion<N, T> move(const JointRoom<N, T>& room,
                                                        const JointVelocity<N, T>& u0,
                                                        const JointVelocity<N, T>& target,
                                                        const T& h) const noexcept {
    return move_inlined(room, u0, target, h);
  }
  /// `move`, inlined, for callers whose next state waits for it: a call passes its numbers by memory, twice.
  [[nodiscard]] SKINCTL_INLINE JointMotion<N, T> move_inlined(const JointRoom<N, T>& room,
                                                              const JointVelocity<N, T>& u0,
                                                              const JointVelocity<N, T>& target,
                                                              const T& h) const noexcept {
    using R = detail::Row<N, T>;
    const R limit = values_.velocity, a = values_.acceleration, from = u0, zero = T(0);
    const R dv = a * R(h), half = T(0.5) * h, rounding = T(1) / braking_share<T>;
    const R wish = select(R(target) == R(target), target, zero);
    R u = clamp(wish, -limit, limit);
    Status status;
    std::uint64_t braked = 0;
    if (any(u != wish)) status |= Reason::velocity_limited;
    // Braking is computed only where the highest speed that this step can reach may not stop in time.
    const R up = from + dv, down = dv - from, above = room.above, below = room.below;
    const auto near_above = (up > zero) & !(half * (from + up) + rounding * stopping_distance(up) < above);
    const auto near_below =
        (down > zero) & !(half * (down - from) + rounding * stopping_distance(down) < below);
    if (any(near_above | near_below)) [[unlikely]] {
      JointVelocity<N, T> slowed(u);
      braked = slow_down(near_above.bits(), near_below.bits(), room, u0, h, slowed);
      if (braked != 0) status |= Reason::position_limited;
      u = slowed;
    }
    const R reached = clamp(u, from - dv, up);
    if (any(reached != u)) status |= Reason::acceleration_limited;
    // A joint that stops within the step may stop earlier than at the end of a straight velocity profile.
    const R stop = stopping_distance(from);
    const R most = select((from > zero) & (stop > above), stop, select(above > zero, above, zero));
    const R least = select((from < zero) & (stop > below), stop, select(below > zero, below, zero));
    // Squares of tiny speeds are denormal numbers, which are slow.
    const R tiny = detail::dust<T>;
    // Built in place: GCC would first zero it, by an instruction that starts slowly.
    return {JointPosition<N, T>(clamp(half * (from + reached), -least, most)),
            JointVelocity<N, T>(select(magnitude(reached) > tiny, reached, zero)), status, braked};
  }

 private:
  /// Slows the joints of the two bit sets to speeds from which they can still stop; returns those it slowed.
  SKINCTL_COLD std::uint64_t slow_down(std::uint64_t near_above, std::uint64_t near_below,
                                       const JointRoom<N, T>& room, const JointVelocity<N, T>& from,
                                       const T& h, JointVelocity<N, T>& u) const noexcept {
    std::uint64_t slowed = 0;
    const T half = T(0.5) * h;
    for (std::size_t i = 0; i < N; ++i) {
      const T brake = values_.acceleration[i] * braking_share<T>, wish = u[i];
      if (((near_above >> i) & 1u) != 0) {
        const T most = speed_to_stop(T(room.above[i] - half * from[i]), half, brake);
        u[i] = u[i] > most ? most : u[i];
      }
      if (((near_below >> i) & 1u) != 0) {
        const T most = speed_to_stop(T(room.below[i] + half * from[i]), half, brake);
        u[i] = u[i] < -most ? -most : u[i];
      }
      if (u[i] != wish) slowed |= std::uint64_t(1) << i;
    }
    return slowed;
  }

  Values values_;
  JointAcceleration<N, T>
      stop_per_square_;  ///< 1 / (2 a): distance in which a joint stops, over its squared speed [s^2/rad]
  bool has_power_ = false;
  const void* robot_ = nullptr;
};

/// Stand-in for jerk limits where there are none: joints move and brake by their own limits alone.
struct Abrupt {
  template <class Set>
  [[nodiscard]] Abrupt set() const noexcept {
    return {};
  }
};

namespace detail {
/// The number of joint `i`, where a maker gives one of each joint, or one of all.
template <class Numbers>
[[nodiscard]] constexpr auto of_joint(const Numbers& numbers, [[maybe_unused]] std::size_t i) noexcept {
  if constexpr (std::is_arithmetic_v<Numbers>) {
    return numbers;
  } else {
    return numbers[i];
  }
}
/// A byte whose address tells of which robot limits are.
template <class Description>
inline constexpr char robot_mark{};
}  // namespace detail

/// Limits from a robot's description: its positions, velocity and torques as the maker publishes them.
///
/// @param acceleration  [rad/s^2] of every joint; makers rarely publish one. Universal Robots' program for
///                      velocity commands uses 40 for a UR5.
/// A model with another description refuses them where they are beyond its own.
template <class Description, Real T = double>
[[nodiscard]] JointLimits<Description::joints, T> limits_of(const T& acceleration = T(40)) {
  typename JointLimits<Description::joints, T>::Values v;
  for (std::size_t i = 0; i < Description::joints; ++i) {
    v.lower[i] = T(Description::lower[i]);
    v.upper[i] = T(Description::upper[i]);
    v.velocity[i] = T(detail::of_joint(Description::max_velocity, i));
    v.acceleration[i] = acceleration;
    v.torque[i] = T(detail::of_joint(Description::max_torque, i));
  }
  return JointLimits<Description::joints, T>(v, &detail::robot_mark<Description>);
}

SKINCTL_END_NAMESPACE
