// SPDX-License-Identifier: BSD-3-Clause
// Keeps links of a robot clear of each other, of known objects and of what moves around it.
#pragma once

#include <limits>

#include "skinctl/clearance/clearances.hpp"
#include "skinctl/core/command.hpp"
#include "skinctl/limits/detail/clearance_ways.hpp"
#include "skinctl/limits/detail/towards.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/math/greatest_share.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Keeps the pairs of a `Clearance` at least its margin apart: a limit of speed in a governor, so it holds
/// whatever a law wants and an energy tank has.
///
/// A velocity is kept only if the robot can stop from it with all clearances above the margin, either along
/// the way on which all joints brake alike, at the rate of the weakest, if they stop before their ends, or
/// along the one on which each joint brakes as it likes. Distances are computed at `stop_checks` positions of
/// it, and must exceed the margin there by what they can fall short in between: `SummedMotion::bend` of the
/// joints between the two bodies. A pair nearer than the margin may only get farther.
///
/// A velocity that would come too close loses the part that closes, and at the margin gains a little that
/// opens; the rest, mixed with braking as far as needed, is kept. So an arm slides along.
///
/// **With obstacles** (`ClearanceAround`, `Around` of them at most) the same holds for them. On a way of t
/// seconds one comes closer by `approach (age + late + t)`: straight towards one that stands at the distance
/// d, that is `v <= sqrt(a^2 T^2 + 2 a (d - d0)) - a T`, with the margin d0, the deceleration a, and T until
/// braking begins. Two robots of which each keeps clear of the space `occupied` by the other until it stands,
/// and that decide in turn, may always go on braking within what the other left free; so the space that a
/// robot may fill stays clear of that of the other by a quarter of the margin; nearer, neither may approach.
///
/// **A robot that does not follow**, because something holds or pushes it, stands off its commands
/// (`stand_off`). Then the same holds for both positions; deviations up to a tenth of the margin are ignored.
template <RobotModel M, Real T = double, std::size_t Around = 0>
class ClearanceLimits {
 public:
  static constexpr std::size_t joints = M::joints, around = Around;
  using scalar = T;
  static constexpr std::size_t max_pairs = Clearances<M, T, Around>::max_pairs;
  static constexpr int stop_checks = 6;  ///< positions checked along a way to stop; fewer: less speed
  using Kind = Clearance;
  static constexpr Precedence precedence = Precedence::clearance;
  static constexpr Reason reason = Reason::clearance_kept;
  using Velocity = JointVelocity<joints, T>;
  using Position = JointPosition<joints, T>;
  using Sum = SummedMotion<M, T>;
  using Near = typename Clearances<M, T, Around>::Near;
  using Here = detail::ClearanceWays<ClearanceLimits>;  ///< the distances at a position, for several queries
  /// The robot's deviation from its commands. Trivially copyable.
  struct Beside {
    Position off{};       ///< measured less expected position [rad]
    bool is_off = false;  ///< `off` is large enough to count
  };
  /// A `Beside`, and the obstacles around the robot, from the input.
  struct Seen : Beside {
    Near near{};
    Position measured{};  ///< measured position of the robot
    T age = T(0);         ///< age of the obstacles now [s]
    bool blind = true;    ///< the obstacles are too old, too many or not finite: nothing may move
  };
  using Memory = std::conditional_t<(Around > 0), Seen, Beside>;
  using Input = std::conditional_t<(Around > 0), AroundRobot<Near>, NoInput>;

  /// Throws `ConfigurationError` as `Clearances` does.
  SKINCTL_COLD ClearanceLimits(const M& model, const JointLimits<joints, T>& limits, const Clearance& given)
      : clearances_(model, given),
        limits_(limits),
        margin_(T(given.margin + spare)),
        reach_(T(given.reach)) {}
  /// Limits with obstacles from the input, too. Throws also for a `late` or `max_age` out of its range.
  SKINCTL_COLD ClearanceLimits(const M& model, const JointLimits<joints, T>& limits,
                               const ClearanceAround<Around>& given)
    requires(Around > 0)
      : clearances_(model, given.own, given.exposed),
        limits_(limits),
        margin_(T(given.own.margin + spare)),
        reach_(T(given.own.reach)),
        late_(seconds<T>(given.late)),
        max_age_(given.max_age) {
    require(given.late >= 0ns && given.late <= 10s, "ClearanceAround: late", milliseconds(given.late),
            "0 to 10 000 ms");
    require(given.max_age > 0ns && given.max_age <= 10s, "ClearanceAround: max_age",
            milliseconds(given.max_age), "> 0, <= 10 000 ms");
  }
  [[nodiscard]] const M& model() const noexcept { return clearances_.model(); }

  /// Takes the obstacles `near`, and the position at which the robot is `measured`. Obstacles that at `now`
  /// are too old, or too many or not finite, make `m` blind: nothing may move then.
  SKINCTL_INLINE void see(Memory& m, const Near& near, const Position& measured,
                          Nanoseconds now) const noexcept
    requires(Around > 0)
  {
    const Nanoseconds age = now - near.time;
    m.near = near;
    m.measured = measured;
    m.age = age > 0ns ? seconds<T>(age) : T(0);
    m.blind = !(age <= max_age_ && age >= -max_age_) || near.count > Around;
    for (std::size_t i = 0; i < near.count && i < Around; ++i) {
      const Obstacle<Base, T>& o = near.obstacles[i];
      const T sum = o.shape.from.x + o.shape.from.y + o.shape.from.z + o.shape.to.x + o.shape.to.y +
                    o.shape.to.z + o.shape.radius;
      m.blind = m.blind || !(sum - sum == T(0)) || !(o.shape.radius >= T(0)) || !(o.approach >= T(0)) ||
                !(o.approach <= T(largest_approach));
    }
  }
  /// Takes the obstacles from the input of a cycle, as a limit of a scene.
  template <class In>
    requires(Around > 0)
  SKINCTL_INLINE void see(Memory& m, const In& in, const Position& measured, Nanoseconds now) const noexcept {
    see(m, in.around, measured, now);
  }
  /// Takes the robot's deviation `off` from its commands: measured less expected positions. NaN counts as 0.
  SKINCTL_INLINE void stand_off(Memory& m, const Position& off) const noexcept {
    Sum sum;
    for (std::size_t i = 0; i < joints; ++i) sum.add(i, off[i]);
    const T way = sum.way(reach_);
    m.off = off;
    m.is_off = way > T(off_from) * margin_ && way - way == T(0);
  }
  /// The space in the base frame that exposed capsules may fill until a robot that brakes now stands: from
  /// `measured` to the last command, and on to where all joints are at rest, however they brake together.
  [[nodiscard]] Surroundings<max_exposed_capsules, Base, T> occupied(
      const JointCommand<joints, T>& last, const State<joints, T>& measured) const noexcept {
    const Box joints_box = until_rest(measured.q, last.position, last.velocity);
    Surroundings<max_exposed_capsules, Base, T> out;
    out.time = measured.time;
    clearances_.sweep(joints_box.middle, joints_box.half, reach_, out);
    return out;
  }

  [[nodiscard]] Here at(const Position& q) const noexcept
    requires(Around == 0)
  {
    static constexpr Memory nothing{};
    return Here(*this, nothing, q);
  }
  /// The distances at `q` beside the obstacles in `seen`, which must outlive the result.
  [[nodiscard]] Here at(const Memory& seen, const Position& q) const noexcept { return Here(*this, seen, q); }
  using Kept = KeptVelocity<joints, T>;
  /// The allowed velocity: motion as far as there is a way to stop, torques as far as they brake in time.
  /// Joints by torque follow later than the others: beside them motion is slowed first.
  template <class Going, class Also>
  [[nodiscard]] SKINCTL_INLINE Kept within(const Memory& seen, const Going& going, const Velocity& u,
                                           const Also& also) const noexcept {
    if constexpr (!Going::by_motion) {
      return braked(seen, going.q, u, going.ahead);
    } else if constexpr (!Going::by_torque) {
      return within(seen, going.q, going.room, going.from, u, going.dt, also, going.slides);
    } else {
      const T part = share(seen, going.q, u, going.ahead);
      if (!(part < T(1)))
        return within(seen, going.q, going.room, going.from, u, going.dt, also, going.slides);
      const Velocity slower = limits_.move(going.room, going.from, part * u, going.dt).velocity;
      Kept out = within(seen, going.q, going.room, going.from, slower, going.dt, also, going.slides);
      out.limited = true;
      return out;
    }
  }
  template <class Going>
  [[nodiscard]] SKINCTL_INLINE bool keeps(const Memory& seen, const Going& going, const Velocity& u,
                                          const Position& moved) const noexcept {
    return keeps(seen, going.q, u, moved, going.room);
  }
  /// The step from `u0` to `u1` over `h` seconds as far as it keeps the clearances and `also(u)`: `u1` if so.
  /// Otherwise it turns along the margin if it `slides`, or else keeps its direction and ends at the margin.
  template <class Also>
  [[nodiscard]] SKINCTL_NOINLINE Kept within(const Memory& seen, const Position& q,
                                             const JointRoom<joints, T>& room, const Velocity& u0,
                                             const Velocity& u1, const T& h, const Also& also,
                                             bool slides = true) const noexcept {
    const Here here = at(seen, q);
    const auto keeps = [&](const Velocity& u) {
      return here.keeps(u, integrate(Position(), u0 + u, T(T(0.5) * h)), room) && also(u);
    };
    if (keeps(u1)) [[likely]]
      return {u1, false};
    T stop(0);
    for (std::size_t i = 0; i < joints; ++i) {
      const T t = Here::size(u0[i]) / (limits_.acceleration()[i] * braking_share<T>);
      stop = t > stop ? t : stop;
    }
    const T left = stop > h ? T(T(1) - h / stop) : T(0);
    Velocity brake = left * u0;
    const Velocity slid = slides ? here.slid(u1, h) : u1;
    Velocity wish = limits_.move(room, u0, slid, h).velocity;
    if (keeps(wish)) return {wish, true};
    // The limits of single joints turn a motion along the margin into it; all joints at one rate do not.
    T part(1);
    for (std::size_t i = 0; i < joints; ++i) {
      const T change = Here::size(slid[i] - u0[i]), most = limits_.acceleration()[i] * h;
      part = part * change > most ? T(most / change) : part;
    }
    wish = limits_.move(room, u0, u0 + part * (slid - u0), h).velocity;
    if (keeps(wish)) return {wish, true};
    if (!here.keeps_alike(brake, integrate(Position(), u0 + brake, T(T(0.5) * h)), room))
      brake = limits_.move(room, u0, Velocity(), h).velocity;
    return {detail::towards(brake, wish, keeps), true};
  }
  /// Whether the motion that ends at the velocity `u` after the displacement `moved` keeps the clearances.
  [[nodiscard]] SKINCTL_NOINLINE bool keeps(const Memory& seen, const Position& q, const Velocity& u,
                                            const Position& moved,
                                            const JointRoom<joints, T>& room) const noexcept {
    return at(seen, q).keeps(u, moved, room);
  }
  /// `u` if the robot can stop after `time` seconds at it; else without what closes, scaled until it can.
  [[nodiscard]] Kept braked(const Memory& seen, const Position& q, const Velocity& u,
                            const T& time) const noexcept {
    if (share(seen, q, u, time) == T(1)) [[likely]]
      return {u, false};
    const Velocity aside = at(seen, q).slid(u, time);
    return {share(seen, q, aside, time) * aside, true};
  }
  /// The share in [0, 1] of `u` from which the robot can stop after `time` seconds at it. 0 for NaN.
  [[nodiscard]] SKINCTL_NOINLINE T share(const Memory& seen, const Position& q, const Velocity& u,
                                         const T& time) const noexcept {
    const Here here = at(seen, q);
    const auto room = limits_.room(q);
    const auto keeps = [&](const T& s) {
      return here.keeps(s * u, integrate(Position(), s * u, time), room);
    };
    if (keeps(T(1))) [[likely]]
      return T(1);
    return math::greatest_share<halvings, T>(keeps);
  }

 private:
  friend Here;
  static constexpr double spare = 1e-4;  ///< distance kept beyond the margin: braking is planned in steps [m]
  static constexpr double off_from = 0.1;          ///< share of the margin up to which a deviation is but lag
  static constexpr double largest_approach = 100;  ///< speed of obstacles, beyond which units are wrong [m/s]
  static constexpr int halvings = 12;  ///< steps of the bisection for a share of a motion: known to 2^-12

  /// The deceleration of joint `i` in plans [rad/s^2]: a little less than it brakes with, for rounding.
  [[nodiscard]] SKINCTL_INLINE T brake(std::size_t i) const noexcept {
    return limits_.acceleration()[i] * braking_share<T> * braking_share<T>;
  }
  /// The time in which all joints come to rest from `u` [s].
  [[nodiscard]] SKINCTL_INLINE T time_to_rest(const Velocity& u) const noexcept {
    T longest(0);
    for (std::size_t i = 0; i < joints; ++i) {
      const T stop = Here::size(u[i]) / brake(i);
      longest = stop > longest ? stop : longest;
    }
    return longest;
  }
  /// Joint positions within `half` of `middle`.
  struct Box {
    Position middle, half;
  };
  /// The joint positions from `was` by way of `q` to rest, for a robot that brakes from the velocity `u` at
  /// `q`, however its joints brake together.
  [[nodiscard]] Box until_rest(const Position& was, const Position& q, const Velocity& u) const noexcept {
    const T longest = time_to_rest(u);
    Box box;
    for (std::size_t i = 0; i < joints; ++i) {
      const T end = q[i] + T(0.5) * longest * u[i];
      T low = q[i] < end ? q[i] : end, high = q[i] < end ? end : q[i];
      low = was[i] < low ? was[i] : low, high = was[i] > high ? was[i] : high;
      box.middle[i] = T(0.5) * (low + high), box.half[i] = T(0.5) * (high - low);
    }
    return box;
  }

  Clearances<M, T, Around> clearances_;
  JointLimits<joints, T> limits_;
  T margin_, reach_;  ///< the margin with `spare`, and the reach of `Clearance` [m]
  T late_ = T(0);
  Nanoseconds max_age_{0};
};

/// The `ClearanceLimits` that `clearance` makes of a robot.
template <RobotModel M, std::size_t N, Real T>
[[nodiscard]] auto part_for(const M& model, const JointLimits<N, T>& limits, const Clearance& clearance) {
  return ClearanceLimits<M, T>(model, limits, clearance);
}
template <RobotModel M, std::size_t N, Real T, std::size_t Most>
[[nodiscard]] auto part_for(const M& model, const JointLimits<N, T>& limits,
                            const ClearanceAround<Most>& clearance) {
  return ClearanceLimits<M, T, Most>(model, limits, clearance);
}

/// The space in the world that the exposed capsules of a robot at `X_WB` may fill from now on until it
/// stands, if it brakes now: for others that keep clear of it.
/// @param scene  a `Cycle` with a `Clearance`.
template <class Scene, Real T>
[[nodiscard]] Surroundings<max_exposed_capsules, World, T> occupied(
    const Scene& scene, const typename Scene::Memory& m, const Transform<World, Base, T>& X_WB) noexcept {
  auto is = m.robot.measured();
  is.q += scene.resolver().gap(m.robot);  // where it really is
  const auto filled = scene.governor().template get<Clearance>().occupied(scene.guard().last(m.guard), is);
  Surroundings<max_exposed_capsules, World, T> out;
  out.time = filled.time;
  out.add(X_WB, filled);
  return out;
}
SKINCTL_END_NAMESPACE
