// SPDX-License-Identifier: BSD-3-Clause
// The space in which Joint Control tracks: the joints themselves.
#pragma once

#include <algorithm>

#include "skinctl/core/status.hpp"
#include "skinctl/law/needs.hpp"
#include "skinctl/tracking/sliding_surface.hpp"
#include "skinctl/trajectory/plan_clock.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A goal position and the time to reach it. Refused beyond the robot's position limits.
template <std::size_t N, Scalar T = double>
struct JointGoal {
  JointPosition<N, T> q_g;
  Nanoseconds
      duration{};  ///< time from reception to arrival; 0: the shortest within velocities and accelerations

  template <class F>
  friend void each_number(JointGoal& g, F&& f) {
    each_number(g.q_g, f), each_number(g.duration, f);
  }
};

/// The joints as the coordinates of a tracking law: the members that `Tracking` uses of a space, at no cost.
///
/// A space has `joints` and `coordinates`, `Settings` (from which `tracking` picks the gains), a `Memory` of
/// its own, `needs`, `of_joints`: whether its coordinates are the joints, and `brief`: whether its surface
/// costs so little that a call would show. For plans:
/// - `Where`, `where`, `place`: a place, that of a state, that of a goal;
/// - goals and their `shortest_time`, a `spline`;
/// - `ahead` and `slow`: a reference later, and with its time slowed down; `stands`: whether it is at rest;
///   `allows`: whether the settings permit it;
/// - `distance` of two references, and its `slowness`: the time that its largest coordinate takes at the
///   largest speed.
///
/// For laws:
/// - `site(known)`, `site(model, q, dq)`: all that it reads of a state;
/// - `errors(target, site, memory)`: eqs. (13) or (20), (21);
/// - `surface(gains, inputs, site, memory)`: the surface and the reference motion of the joints;
/// - `joint_speed(x, site, memory)`: the joints' speed for that of the coordinates;
/// - `course(surface)`: the reference motion of the coordinates;
/// - `rows(site, J)`: the derivatives of the coordinates by the joints; `follow_branch`: the memory of a law
///   that has no surface;
/// - `advanced(memory, surface, dt)`, `take_up(memory, S_q)` at the start, `renewed(memory)` after a reset,
///   `status(memory)`.
template <std::size_t N, Real T = double>
class JointSpace {
 public:
  static constexpr const char* name = "joint";                ///< name of laws that follow targets
  static constexpr const char* spline_name = "spline_joint";  ///< name of laws that go to goals
  static constexpr std::size_t joints = N;
  static constexpr std::size_t coordinates = N;
  static constexpr Needs needs = {};
  static constexpr bool brief = true;
  static constexpr bool of_joints = true;
  using scalar = T;
  using Settings = JointControlSettings<N, T>;
  template <class Robot>
  [[nodiscard]] static Settings settings_of(const Robot& robot) {
    return tracking_settings(robot);
  }
  using Surface = SlidingSurface<N, T>;
  using Reference = JointReference<N, T>;
  using Inputs = SurfaceInputs<N, T>;
  using Errors = SurfaceErrors<N, T>;
  using Where = JointPosition<N, T>;
  using Goal = JointGoal<N, T>;
  using Spline = JointSpline<N, T>;
  using Row = detail::Row<N, T>;
  struct Memory {};
  struct Placement {};  ///< pose of a frame in its link: of joints, none
  struct Site {
    const JointPosition<N, T>& q;
    const JointVelocity<N, T>& dq;
  };
  struct Course {
    const JointVelocity<N, T>& v;
    const JointAcceleration<N, T>& a;
  };

  JointSpace() noexcept = default;
  [[nodiscard]] static SKINCTL_INLINE constexpr const Settings& tracking(const Settings& s) noexcept {
    return s;
  }

  // Of plans.
  [[nodiscard]] static SKINCTL_INLINE const Where& where(const Site& at) noexcept { return at.q; }
  /// The motion of the robot, as a reference without acceleration.
  [[nodiscard]] static Reference motion(const Site& at) noexcept { return {at.q, at.dq, {}}; }
  [[nodiscard]] static SKINCTL_INLINE const Where& where_of(const Reference& r) noexcept { return r.q_d; }
  [[nodiscard]] static SKINCTL_INLINE constexpr const Where& place(const Goal& goal) noexcept {
    return goal.q_g;
  }
  [[nodiscard]] static SKINCTL_INLINE constexpr const Where& place(const Reference& r) noexcept {
    return r.q_d;
  }
  [[nodiscard]] static SKINCTL_INLINE constexpr Spline spline(const Where& from, const Where& to,
                                                              const T& tf) noexcept {
    return {from, to, tf};
  }
  /// Whether a reference is at rest.
  [[nodiscard]] static constexpr bool stands(const Reference& r) noexcept {
    for (const T& v : r.dq_d)
      if (v != T(0)) return false;
    return true;
  }
  /// Shortest time from `from` to `goal` within the largest velocities and accelerations [s]; NaN or infinite
  /// if the goal is not finite.
  [[nodiscard]] static T shortest_time(const Where& from, const Goal& goal, const Settings& s) noexcept {
    T least(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T time =
          shortest_spline_time(T(goal.q_g[i] - from[i]), s.max_velocity[i], s.joint_acceleration[i]);
      if (!(time <= least)) least = time;
      if (!(time - time == T(0))) return time;
    }
    return least;
  }
  static SKINCTL_INLINE void slow(Reference& r, const OwnTime<T>& own) noexcept {
    const Row dq_d = r.dq_d, ddq_d = r.ddq_d;
    (T(own.rate * own.rate) * ddq_d + own.bend * dq_d).store(r.ddq_d);
    (own.rate * dq_d).store(r.dq_d);
  }
  [[nodiscard]] static SKINCTL_INLINE Reference ahead(const Reference& r, const T& t) noexcept {
    const Row q = r.q_d, dq = r.dq_d, ddq = r.ddq_d;
    return {Where(q + t * (dq + T(T(0.5) * t) * ddq)), JointVelocity<N, T>(dq + t * ddq),
            JointAcceleration<N, T>(ddq)};
  }
  [[nodiscard]] static bool finite(const Reference& r) noexcept {
    T sum(0);
    for (std::size_t i = 0; i < N; ++i) sum = sum + r.q_d[i] + r.dq_d[i] + r.ddq_d[i];
    return sum - sum == T(0);
  }
  /// A reference at the place of `r` that goes on with constant velocity.
  [[nodiscard]] static Reference drifting(const Reference& r) noexcept { return {r.q_d, r.dq_d, {}}; }
  /// A reference at rest at the place of `r`.
  [[nodiscard]] static Reference resting(const Reference& r) noexcept { return {r.q_d, {}, {}}; }
  /// Moves `r` on by `dt` towards a target, within the limits, each joint on its own.
  SKINCTL_COLD static void react(Reference& r, const Reference& target, const Settings& s,
                                 const T& dt) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      Pursuit<1, T> one{{r.dq_d[i]}, {r.ddq_d[i]}};
      const T e[1] = {target.q_d[i] - r.q_d[i]}, v[1] = {target.dq_d[i]};
      T moved[1];
      one.advance(e, v,
                  {s.max_velocity[i], std::min(s.max_acceleration, s.joint_acceleration[i]), s.max_jerk}, dt,
                  moved);
      r.q_d[i] = r.q_d[i] + moved[0];
      r.dq_d[i] = one.v[0];
      r.ddq_d[i] = one.a[0];
    }
  }
  [[nodiscard]] static bool allows(const Reference& r, const Settings& s) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const T sum = r.q_d[i] + r.dq_d[i] + r.ddq_d[i];
      if (!(sum - sum == T(0)) || !(detail::magnitude(r.dq_d[i]) < s.max_velocity[i])) return false;
    }
    return true;
  }
  /// Position errors of `a` against `b`, in the form of `errors`.
  [[nodiscard]] static Errors distance(const Reference& a, const Reference& b) noexcept {
    Errors error{};
    for (std::size_t i = 0; i < N; ++i) error.e[i] = a.q_d[i] - b.q_d[i];
    return error;
  }
  /// Longest time [s] that an error takes at its joint's largest speed less the target's; NaN or infinite if
  /// an error is.
  [[nodiscard]] static T slowness(const Errors& error, const Settings& s) noexcept {
    T most(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T speed = s.max_velocity[i] - detail::magnitude(error.v_d[i]);
      if (most == most && speed > T(0) && !(detail::magnitude(error.e[i]) <= most * speed))
        most = detail::magnitude(error.e[i]) / speed;
    }
    return most;
  }

  /// The largest speed by which a joint misses its course, as a share of its `max_velocity`.
  [[nodiscard]] static SKINCTL_INLINE T share_of_speed(const Surface& surface, const Settings& s) noexcept {
    T most(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T share = detail::magnitude(surface.S_delta[i]) / s.max_velocity[i];
      if (share > most) most = share;
    }
    return most;
  }

  // Of laws.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Site site(const K& known) const noexcept {
    return {known.q(), known.dq()};
  }
  template <class M>
  [[nodiscard]] SKINCTL_INLINE Site site(const M&, const JointPosition<N, T>& q,
                                         const JointVelocity<N, T>& dq) const noexcept {
    return {q, dq};
  }
  [[nodiscard]] static SKINCTL_INLINE Errors errors(const Reference& target, const Site& at,
                                                    const Memory&) noexcept {
    Errors error;
    const Row v_d = target.dq_d, a_d = target.ddq_d, de = at.dq - v_d;
    (Row(at.q) - target.q_d).store(error.e);
    de.store(error.de);
    de.store(error.slope);
    v_d.store(error.v_d);
    a_d.store(error.a_d);
    return error;
  }
  template <class Gains>
  [[nodiscard]] SKINCTL_INLINE Surface surface(const Gains& gains, const Inputs& in, const Site& at,
                                               const Memory& memory) const noexcept {
    return sliding_surface(gains, in, errors(in.target, at, memory),
                           [&](const Row& dq_r)
                               SKINCTL_INLINE_LAMBDA { return JointVelocity<N, T>(at.dq - dq_r); });
  }
  /// The joints' velocity for the velocity `x` of the coordinates: `x` itself [rad/s].
  [[nodiscard]] static SKINCTL_INLINE const JointVelocity<N, T>& joint_speed(const JointVelocity<N, T>& x,
                                                                             const Site&,
                                                                             const Memory&) noexcept {
    return x;
  }
  /// The derivatives of the coordinates by the joints, row by row.
  static void rows(const Site&, T (&J)[coordinates][N]) noexcept {
    for (std::size_t c = 0; c < N; ++c)
      for (std::size_t i = 0; i < N; ++i) J[c][i] = c == i ? T(1) : T(0);
  }
  static SKINCTL_INLINE void follow_branch(Memory&, const Reference&, const Site&) noexcept {}
  [[nodiscard]] static SKINCTL_INLINE Course course(const Surface& s) noexcept { return {s.dq_r, s.ddq_r}; }
  [[nodiscard]] static SKINCTL_INLINE Memory advanced(const Memory&, const Surface&, const T&) noexcept {
    return {};
  }
  static SKINCTL_INLINE void take_up(Memory&, const JointVelocity<N, T>&) noexcept {}
  [[nodiscard]] static SKINCTL_INLINE Memory renewed(const Memory&) noexcept { return {}; }
  [[nodiscard]] static SKINCTL_INLINE Status status(const Memory&) noexcept { return {}; }
};

SKINCTL_END_NAMESPACE
