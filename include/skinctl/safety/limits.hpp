// Limits of the joints, and the motion that keeps all of them: a braking distance is always left.
#pragma once

#include <cmath>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Largest speed from which a joint that brakes with `deceleration` > 0 after `reaction` >= 0 seconds at that
/// speed stops within `distance`: the root of `u^2 / (2 a) + u t = d`. Zero for distances <= 0.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T speed_to_stop(const T& distance, const T& reaction,
                                             const T& deceleration) noexcept {
  using std::sqrt;
  if (!(distance > T(0))) return T(0);
  return T(2) * distance / (reaction + sqrt(reaction * reaction + T(2) * distance / deceleration));
}

/// How much of the acceleration limit braking for a position limit is planned with: the rest is for rounding.
template <Real T>
inline const T braking_share = T(1) - T(1024) * std::numeric_limits<T>::epsilon();

/// Distances to the two ends of where a joint may go; negative beyond an end.
template <std::size_t N, Real T = double>
struct JointRoom {
  JointPosition<N, T> below;
  JointPosition<N, T> above;
};

/// How joints move over one step: by `displacement`, reaching `velocity`. `status` says which limits acted,
/// `braked` (bit i for joint i) which joints were slowed for want of room.
template <std::size_t N, Real T = double>
struct JointMotion {
  JointPosition<N, T> displacement;
  JointVelocity<N, T> velocity;
  Status status;
  std::uint64_t braked = 0;
};

/// Limits of `N` joints; immutable, checked when built.
template <std::size_t N, Real T = double>
class JointLimits {
 public:
  struct Values {
    JointPosition<N, T> lower;             ///< [rad], [m]; -infinity for a joint without end
    JointPosition<N, T> upper;             ///< [rad], [m]; above `lower`; infinity for a joint without end
    JointVelocity<N, T> velocity;          ///< magnitude [rad/s], > 0
    JointAcceleration<N, T> acceleration;  ///< magnitude [rad/s^2], > 0, with which the joint can also brake
    JointTorque<N, T> torque;              ///< magnitude [N m], > 0
    /// Most that a joint drives with, `tau dq` [W], > 0; braking is free. Infinity by default.
    JointPower<N, T> power = JointPower<N, T>::constant(std::numeric_limits<T>::infinity());
  };

  /// Throws `ConfigurationError` for a number out of its range, with the number.
  SKINCTL_COLD explicit JointLimits(const Values& values) : values_(values) {
    const T big = std::numeric_limits<T>::max();
    for (std::size_t i = 0; i < N; ++i) {
      const auto number = [](const T& x) { return static_cast<double>(x); };
      require(values.lower[i] < values.upper[i], "lower position limit", number(values.lower[i]),
              "below the upper one");
      require(values.velocity[i] > T(0) && values.velocity[i] <= T(1e3), "velocity limit",
              number(values.velocity[i]), "> 0, <= 1e3 rad/s");
      require(values.acceleration[i] > T(0) && values.acceleration[i] <= T(1e5), "acceleration limit",
              number(values.acceleration[i]), "> 0, <= 1e5 rad/s^2");
      require(values.torque[i] > T(0) && values.torque[i] <= big, "torque limit", number(values.torque[i]),
              "> 0 N m, finite");
      require(values.power[i] > T(0), "power limit", number(values.power[i]), "> 0 W");
      has_power_ = has_power_ || values.power[i] <= big;
    }
  }

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

  /// Distances from `q` to the position limits.
  [[nodiscard]] SKINCTL_INLINE JointRoom<N, T> room(const JointPosition<N, T>& q) const noexcept {
    return {q - values_.lower, values_.upper - q};
  }
  /// Whether every joint is within its position limits.
  [[nodiscard]] SKINCTL_INLINE bool hold(const JointPosition<N, T>& q) const noexcept {
    bool inside = true;
    for (std::size_t i = 0; i < N; ++i) inside &= q[i] >= values_.lower[i] && q[i] <= values_.upper[i];
    return inside;
  }

  /// `tau`, cut to the limits of torque, and of power at the speeds `dq`.
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> within(const JointTorque<N, T>& tau,
                                                        const JointVelocity<N, T>& dq) const noexcept {
    JointTorque<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      const T limit = values_.torque[i];
      out[i] = tau[i] < -limit ? -limit : (tau[i] > limit ? limit : tau[i]);
      if (has_power_ && out[i] * dq[i] > values_.power[i]) [[unlikely]]
        out[i] = values_.power[i] / dq[i];
    }
    return out;
  }

  /// The motion over `h` > 0 seconds from velocity `u0` towards velocity `target` that keeps the limits.
  ///
  /// Each joint's velocity runs from `u0` to the new one such that its acceleration never exceeds the limit,
  /// and the new one is small enough to stop within `room` at the acceleration limit, whatever the following
  /// steps' lengths are: from a state that this function left, no position limit is ever crossed. In order of
  /// precedence: acceleration (a command never steps), then room, then velocity, then the target. So a joint
  /// that *starts* too fast to stop brakes as hard as it may, and beyond an end only inward motion is given.
  /// A target that is NaN counts as zero, and so does a resulting speed whose square would be a denormal
  /// number (below 1e-17 rad/s in float, 1e-150 in double): those are slow, and a robot at rest has them.
  [[nodiscard]] SKINCTL_NOINLINE JointMotion<N, T> move(const JointRoom<N, T>& room,
                                                        const JointVelocity<N, T>& u0,
                                                        const JointVelocity<N, T>& target,
                                                        const T& h) const noexcept {
    JointMotion<N, T> out;
    const T least = T(std::same_as<T, float> ? 1e-17 : 1e-150);
    bool velocity = false, acceleration = false;
    for (std::size_t i = 0; i < N; ++i) {
      const T limit = values_.velocity[i], a = values_.acceleration[i], from = u0[i], dv = a * h;
      const T wish = target[i] == target[i] ? target[i] : T(0);
      T u = wish < -limit ? -limit : (wish > limit ? limit : wish);
      velocity |= u != wish;
      const T capped = u;
      // Braking is looked at only where the fastest that this step can reach may not stop in time.
      const T brake = a * braking_share<T>, half = T(0.5) * h;
      const T up = from + dv, down = dv - from;
      if (up > T(0) && !(half * (from + up) + up * up / (T(2) * brake) < room.above[i])) [[unlikely]] {
        const T most = speed_to_stop(T(room.above[i] - half * from), half, brake);
        u = u > most ? most : u;
      }
      if (down > T(0) && !(half * (down - from) + down * down / (T(2) * brake) < room.below[i]))
          [[unlikely]] {
        const T most = speed_to_stop(T(room.below[i] + half * from), half, brake);
        u = u < -most ? -most : u;
      }
      if (u != capped) [[unlikely]]
        out.braked |= std::uint64_t(1) << i;
      const T before = u;
      u = u > from + dv ? from + dv : (u < from - dv ? from - dv : u);
      acceleration |= u != before;
      T s = half * (from + u);
      // A joint that stops within the step may stop earlier than a straight line does.
      const T stop = from * from / (T(2) * a);
      const T above =
          from > T(0) && stop > room.above[i] ? stop : (room.above[i] > T(0) ? room.above[i] : T(0));
      const T below =
          from < T(0) && stop > room.below[i] ? stop : (room.below[i] > T(0) ? room.below[i] : T(0));
      s = s > above ? above : (s < -below ? -below : s);
      // Squares of what is next to nothing are denormal numbers, which are slow.
      out.velocity[i] = u > least || u < -least ? u : T(0);
      out.displacement[i] = s;
    }
    if (out.braked != 0) out.status |= Reason::position_limited;
    if (velocity) out.status |= Reason::velocity_limited;
    if (acceleration) out.status |= Reason::acceleration_limited;
    return out;
  }

 private:
  Values values_;
  bool has_power_ = false;
};

/// Limits from a robot's description: its positions, velocity and torques as the maker publishes them.
///
/// @param acceleration  [rad/s^2] of every joint; makers rarely publish one. 40 is what the maker's program
///                      for velocity commands asks of a UR5.
template <class Description, Real T = double>
[[nodiscard]] JointLimits<Description::joints, T> limits_of(const T& acceleration = T(40)) {
  typename JointLimits<Description::joints, T>::Values v;
  for (std::size_t i = 0; i < Description::joints; ++i) {
    v.lower[i] = T(Description::lower[i]);
    v.upper[i] = T(Description::upper[i]);
    if constexpr (requires { Description::max_velocity[0]; }) {
      v.velocity[i] = T(Description::max_velocity[i]);
    } else {
      v.velocity[i] = T(Description::max_velocity);
    }
    v.acceleration[i] = acceleration;
    if constexpr (requires { Description::max_torque[0]; }) {
      v.torque[i] = T(Description::max_torque[i]);
    } else {
      v.torque[i] = T(Description::max_torque);
    }
  }
  return JointLimits<Description::joints, T>(v);
}

SKINCTL_END_NAMESPACE
