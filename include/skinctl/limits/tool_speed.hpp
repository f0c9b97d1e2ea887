// SPDX-License-Identifier: BSD-3-Clause
// A limit on the speed of a point of the robot, such as its tool.
#pragma once

#include <cmath>

#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/kinematics/summed_motion.hpp"
#include "skinctl/limits/detail/towards.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The kind of `MaxToolSpeed`, for `Cycle::without`.
struct ToolSpeedLimit {};

/// A limit on the speed [m/s] of a point fixed to link `Ix`.
///
/// At constant joint velocities the point gets faster as the arm stretches, and a joint that brakes for its
/// end no longer cancels the motion of the others. So a state keeps the limit only if it has a way to stop
/// along which the point stays below it and every joint stops before its end:
/// - either each joint brakes as it likes: `sum |u_i| |J_i|`, with columns of the point's Jacobian that grow
///   on the way, is below the limit;
/// - or all joints brake alike, at the rate of the weakest. With `v = |J u|`, growth `K = R w^2 + 2 w s` of
///   the joints that turn by w in sum and those that slide by s (`SummedMotion`), and rate `a = min A_i
///   / |u_i|` the largest speed is v if `K <= a v`, else at most `2/3 v + K/(3 a)`, and joint i covers `|u_i|
///   / (2 a)`.
template <RobotModel M, std::size_t Ix, Real T = double>
class ToolSpeed {
 public:
  static_assert(Ix < M::joints, "the speed of a link that the model does not have");
  static constexpr std::size_t joints = M::joints;
  static constexpr std::size_t link = Ix;
  using Kind = ToolSpeedLimit;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::tool_speed;
  static constexpr Reason reason = Reason::tool_speed_limited;

  struct Values {
    T speed;                            ///< largest speed of the point [m/s], > 0
    Xyz<T> point = {T(0), T(0), T(0)};  ///< point along the axes of link `Ix`, from its origin [m]
    T reach;                            ///< R: largest distance of the point from any axis that turns it [m]
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD ToolSpeed(const M& model, const JointLimits<joints, T>& limits, const Values& values)
      : model_(model), limits_(limits), values_(values) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(values.speed > T(0) && values.speed <= T(100), "tool speed", number(values.speed),
            "> 0, <= 100 m/s");
    require(values.reach > T(0) && values.reach <= T(100), "reach of the tool", number(values.reach),
            "> 0, <= 100 m");
    require(dot(values.point, values.point) <= T(1e4), "point of the tool",
            number(dot(values.point, values.point)), "within 100 m of its link");
  }

  [[nodiscard]] T limit() const noexcept { return values_.speed; }
  [[nodiscard]] const M& model() const noexcept { return model_; }

  using Kept = KeptVelocity<joints, T>;

  /// The point's Jacobian at a joint position, for several queries.
  class At {
   public:
    /// The point's speed at the joint velocity `u`, `|J u|` [m/s].
    [[nodiscard]] SKINCTL_INLINE T speed(const JointVelocity<joints, T>& u) const noexcept {
      using std::sqrt;
      Xyz<T> v{T(0), T(0), T(0)};
      for (std::size_t i = 0; i < joints; ++i) v = v + u[i] * column_[i];
      return sqrt(dot(v, v));
    }
    /// Whether there is a way to stop from the velocity `u`, reached by the displacement `moved`, that keeps
    /// the limit within `room`, the joints' distances to their ends before the motion. False for NaN.
    [[nodiscard]] SKINCTL_INLINE bool keeps(const JointVelocity<joints, T>& u,
                                            const JointPosition<joints, T>& moved,
                                            const JointRoom<joints, T>& room) const noexcept {
      using std::sqrt;
      const auto size = [](const T& x) SKINCTL_INLINE_LAMBDA { return x < T(0) ? T(-x) : x; };
      const T R = of_.values_.reach, most = of_.limit();
      T rate = std::numeric_limits<T>::infinity();
      SummedMotion<M, T> sum, path, stop;
      for (std::size_t i = 0; i < joints; ++i) {
        const T w = size(u[i]), brake = of_.brake(i);
        sum.add(i, w), path.add(i, moved[i]), stop.add(i, w * w / (T(2) * brake));
        if (w * rate > brake) rate = brake / w;
      }
      T alone = (path + stop).bend(R, sum);
      for (std::size_t i = 0; i < joints; ++i) alone = alone + size(u[i]) * sqrt(dot(column_[i], column_[i]));
      if (alone <= most) return true;
      const T v = speed(u) + path.bend(R, sum), growth = sum.bend(R);
      if (!(growth <= rate * v ? v <= most : T(2) * v + growth / rate <= T(3) * most)) return false;
      return stops_inside(u, moved, room, T(T(1) / rate));
    }
    /// Whether every joint stops within `room` if all, after `moved`, brake alike from `u` for `time`
    /// seconds.
    [[nodiscard]] SKINCTL_INLINE bool stops_inside(const JointVelocity<joints, T>& u,
                                                   const JointPosition<joints, T>& moved,
                                                   const JointRoom<joints, T>& room,
                                                   const T& time) const noexcept {
      for (std::size_t i = 0; i < joints; ++i) {
        const T way = T(0.5) * time * u[i] + moved[i];
        if ((u[i] > T(0) && !(way <= room.above[i])) || (u[i] < T(0) && !(-way <= room.below[i])))
          return false;
      }
      return true;
    }

   private:
    friend ToolSpeed;
    At(const ToolSpeed& of, const JointPosition<joints, T>& q) noexcept : of_(of) {
      const auto J = jacobian<Ix>(Poses<M, closure<M>(link_bit<Ix>), T>(of.model_, q), at(of.values_.point));
      J.for_each([&](auto i, const auto& c) { column_[i.value] = c.linear; });
    }
    static Transform<Link<Ix>, Cell, T> at(const Xyz<T>& p) noexcept {
      return Transform<Link<Ix>, Cell, T>::trusted(
          {Xyz<T>{T(1), T(0), T(0)}, Xyz<T>{T(0), T(1), T(0)}, Xyz<T>{T(0), T(0), T(1)}}, p);
    }
    const ToolSpeed& of_;
    Xyz<T> column_[joints] = {};
  };
  [[nodiscard]] SKINCTL_INLINE At at(const JointPosition<joints, T>& q) const noexcept {
    return At(*this, q);
  }

  /// The share in [0, 1] of `u` with which the point keeps the limit for the next `time` seconds: the root of
  /// `s v + s^2 K time = limit`. 0 for NaN.
  [[nodiscard]] SKINCTL_NOINLINE T share(const JointPosition<joints, T>& q, const JointVelocity<joints, T>& u,
                                         const T& time) const noexcept {
    using std::sqrt;
    SummedMotion<M, T> sum;
    for (std::size_t i = 0; i < joints; ++i) sum.add(i, u[i]);
    const T v = at(q).speed(u), growth = sum.bend(values_.reach) * time, most = limit();
    if (v + growth <= most) [[likely]]
      return T(1);
    const T s = T(2) * most / (v + sqrt(v * v + T(4) * growth * most));
    return s > T(0) ? s : T(0);
  }

  /// Whether the motion that ends at the velocity `u` after the displacement `moved` keeps the limit; see
  /// `At::keeps`.
  [[nodiscard]] SKINCTL_NOINLINE bool keeps(const JointPosition<joints, T>& q,
                                            const JointVelocity<joints, T>& u,
                                            const JointPosition<joints, T>& moved,
                                            const JointRoom<joints, T>& room) const noexcept {
    return at(q).keeps(u, moved, room);
  }

  /// The step from `u0` to `u1`, both within the joints' limits, over `h` seconds as far as it keeps the
  /// limit within `room`: `u1` if it does. Otherwise joints on the way to their ends are slowed first, so
  /// that they can brake together with the others; then the step is mixed with the one that brakes all joints
  /// alike, or with the one that brakes each on its own. The latter alone if no mix keeps the limit.
  [[nodiscard]] SKINCTL_NOINLINE Kept within(const JointPosition<joints, T>& q,
                                             const JointRoom<joints, T>& room,
                                             const JointVelocity<joints, T>& u0,
                                             const JointVelocity<joints, T>& u1, const T& h) const noexcept {
    using Velocity = JointVelocity<joints, T>;
    const At here = at(q);
    const auto moved = [&](const Velocity& u) {
      return integrate(JointPosition<joints, T>(), u0 + u, T(T(0.5) * h));
    };
    const auto keeps_in = [&](const JointRoom<joints, T>& given, const Velocity& u) {
      return here.keeps(u, moved(u), given);
    };
    // A margin for the rounding of positions while it brakes.
    const T margin = T(256) * std::numeric_limits<T>::epsilon();
    const JointRoom<joints, T> less{room.below - JointPosition<joints, T>::constant(margin),
                                    room.above - JointPosition<joints, T>::constant(margin)};
    const auto keeps = [&](const Velocity& u) { return keeps_in(less, u); };
    if (keeps(u1)) [[likely]]
      return {u1, false};
    const T stop = time_to_stop(u0), left = stop > h ? T(T(1) - h / stop) : T(0);
    Velocity brake = left * u0;  // the weakest joint stops last
    if (!keeps_in(room, brake)) {
      const Velocity alone = limits_.move(room, u0, Velocity(), h).velocity;
      if (keeps_in(room, alone) || !here.stops_inside(brake, moved(brake), room, T(stop - h))) brake = alone;
    }
    const Velocity wish = beside_ends(less, u0, u1, h);
    if (!(wish == u1) && keeps(wish)) return {wish, true};
    return {detail::towards(brake, wish, keeps), true};
  }

  /// The allowed velocity, as a limit of a scene: motion as far as the way to stop keeps the limit, torques
  /// as far as the next `going.ahead` seconds do.
  template <class Going, class Also>
  [[nodiscard]] SKINCTL_INLINE Kept within(const Memory&, const Going& going,
                                           const JointVelocity<joints, T>& u, const Also&) const noexcept {
    if constexpr (Going::by_motion) {
      return within(going.q, going.room, going.from, u, going.dt);
    } else {
      const T part = share(going.q, u, going.ahead);
      return {part < T(1) ? part * u : u, part < T(1)};
    }
  }
  template <class Going>
  [[nodiscard]] SKINCTL_INLINE bool keeps(const Memory&, const Going& going,
                                          const JointVelocity<joints, T>& u,
                                          const JointPosition<joints, T>& moved) const noexcept {
    return keeps(going.q, u, moved, going.room);
  }

 private:
  /// The deceleration of joint `i` in plans [rad/s^2]: a little less than it brakes with, for rounding.
  [[nodiscard]] SKINCTL_INLINE T brake(std::size_t i) const noexcept {
    return limits_.acceleration()[i] * braking_share<T> * braking_share<T>;
  }
  /// The time in which all joints, braking alike, come to rest from `u` [s].
  [[nodiscard]] SKINCTL_INLINE T time_to_stop(const JointVelocity<joints, T>& u) const noexcept {
    T longest(0);
    for (std::size_t i = 0; i < joints; ++i) {
      const T stop = (u[i] < T(0) ? T(-u[i]) : u[i]) / (limits_.acceleration()[i] * braking_share<T>);
      if (stop > longest) longest = stop;
    }
    return longest;
  }
  /// `u1`, with each joint slowed such that it stops before its end if all brake alike; within the
  /// acceleration limits from `u0`.
  [[nodiscard]] SKINCTL_INLINE JointVelocity<joints, T> beside_ends(const JointRoom<joints, T>& room,
                                                                    const JointVelocity<joints, T>& u0,
                                                                    const JointVelocity<joints, T>& u1,
                                                                    const T& h) const noexcept {
    JointVelocity<joints, T> u = u1;
    const T stop = time_to_stop(u1) / braking_share<T>;
    for (std::size_t i = 0; i < joints; ++i) {
      // h (u0 + u)/2 + u stop/2 <= room
      const T above = (T(2) * room.above[i] - h * u0[i]) / (h + stop),
              below = (T(2) * room.below[i] + h * u0[i]) / (h + stop), dv = limits_.acceleration()[i] * h;
      if (u[i] > T(0) && u[i] > above) u[i] = above > T(0) ? above : T(0);
      if (u[i] < T(0) && -u[i] > below) u[i] = below > T(0) ? T(-below) : T(0);
      u[i] = u[i] > u0[i] + dv ? u0[i] + dv : (u[i] < u0[i] - dv ? u0[i] - dv : u[i]);
    }
    return u;
  }

  [[no_unique_address]] M model_;
  JointLimits<joints, T> limits_;
  Values values_;
};

/// Part for `Cycle::with`: the largest speed of a point of link `Ix`.
template <std::size_t Ix, Real T = double>
struct MaxToolSpeed {
  using Kind = ToolSpeedLimit;
  T speed;                            ///< largest speed of the point [m/s], > 0
  Xyz<T> point = {T(0), T(0), T(0)};  ///< point along the axes of link `Ix`, from its origin [m]
  T reach;                            ///< largest distance of the point from any axis that turns it [m]
};

/// The `ToolSpeed` limit that `max` makes of a robot.
template <RobotModel M, std::size_t N, std::size_t Ix, Real T>
[[nodiscard]] auto part_for(const M& model, const JointLimits<N, T>& limits, const MaxToolSpeed<Ix, T>& max) {
  return ToolSpeed<M, Ix, T>(model, limits, {max.speed, max.point, max.reach});
}

SKINCTL_END_NAMESPACE
