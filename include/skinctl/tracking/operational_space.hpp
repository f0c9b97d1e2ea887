// SPDX-License-Identifier: BSD-3-Clause
// The space in which Operational Control tracks: the pose of a tool, section 4.2.2.
#pragma once

#include "skinctl/core/status.hpp"
#include "skinctl/law/needs.hpp"
#include "skinctl/tracking/pose_targets.hpp"
#include "skinctl/tracking/singular_escape.hpp"
#include "skinctl/tracking/singular_rest.hpp"
#include "skinctl/tracking/speed_limit.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The pose of the frame `P`, fixed to link `Ix`, as the coordinates of a tracking law, eqs. (15)-(21): its
/// origin [m], then its orientation, or the origin alone.
///
/// `dq_r = J^+ dx_r`, with the damped inverse; `ddq_r` is its derivative, that of the damping included;
/// `S_q = dq - dq_r`, so that `J S_q = S_xdelta + K_i1 I1 + K_i2 I2` where nothing is damped or limited. Next
/// to a singularity the arm slows down (`Reason::slowed`).
///
/// @tparam What         `TaskSpace::pose` or `TaskSpace::position`.
/// @tparam Orientation  `RotationVectorError` or `ZyzError`.
/// @tparam Null         `DampedNullSpace` or `FreeNullSpace`: the joints' motion in the tool's null space.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double, TaskSpace What = TaskSpace::pose,
          class Orientation = RotationVectorError, class Null = DampedNullSpace>
class OperationalSpace : public PoseTargets<N, P, T, What> {
  using Targets = PoseTargets<N, P, T, What>;
  using Targets::get;
  using Targets::put;

 public:
  static constexpr const char* name = "operational";                ///< name of laws that follow targets
  static constexpr const char* spline_name = "spline_operational";  ///< name of laws that go to goals
  static constexpr std::size_t joints = N;
  using Targets::coordinates;
  static constexpr Needs needs = {.jacobians = link_bit<Ix>};
  static constexpr bool brief = false;
  static constexpr bool of_joints = false;
  using scalar = T;
  using Placement = Transform<Link<Ix>, P, T>;  ///< pose of the frame in its link
  using typename Targets::Errors;
  using typename Targets::Reference;
  using typename Targets::Settings;
  using typename Targets::Where;
  using Inputs = SurfaceInputs<coordinates, T, Reference>;

  struct Memory {
    Xyz<T> branch{T(0), T(0), T(0)};  ///< branch of the orientation error, see `OrientationErrors` [rad]
    SingularEscape<N, T> escape;      ///< motion out of a singularity that the damped inverse does not find
    SingularRest<N, T> rest;          ///< rest at a goal next to a singularity
    JointVelocity<N, T> drift;  ///< joint velocity at the start beyond that of the tool's course [rad/s]
    bool slowed = false;        ///< slowed next to a singularity, or at the largest speed of a joint
  };
  struct Surface {
    JointVelocity<coordinates, T> S_delta;  ///< difference to the sliding surface, eq. (19) [m/s], [rad/s]
    JointVelocity<coordinates, T> dI1, dI2;
    JointVelocity<coordinates, T> dx_r;       ///< reference velocity of the tool, eq. (18) [m/s], [rad/s]
    JointAcceleration<coordinates, T> ddx_r;  ///< time derivative of dx_r
    JointVelocity<N, T> dq_r;                 ///< reference velocity of the joints, eq. (15) [rad/s]
    JointAcceleration<N, T> ddq_r;
    JointVelocity<N, T> S_q;
    JointVelocity<N, T> way_out;  ///< joint velocity that `escape` goes over to [rad/s]
    JointPosition<N, T> q;        ///< joint positions, set only next to a singularity [rad]
    bool rests;                   ///< the goal is reached next to a singularity: see `SingularRest`
    Xyz<T> branch;                ///< `Memory::branch` for the next cycle [rad]
    bool slowed;
  };
  struct Course {
    const JointVelocity<coordinates, T>& v;
    const JointAcceleration<coordinates, T>& a;
  };
  /// The part of a state that is read: the tool's Jacobian, pose and velocity.
  template <class J>
  struct Site {
    const JointPosition<N, T>& q;
    const JointVelocity<N, T>& dq;
    J jacobian;
    Where X_BP;
    Twist<P, Base, P, Base, T> V;
  };

  /// @param X_LP  the frame in its link.
  explicit OperationalSpace(const Transform<Link<Ix>, P, T>& X_LP, const Settings& settings = {})
      : X_LP_(X_LP),
        min_damping_(settings.min_damping),
        singularities_(settings.singularities),
        limit_(T(reference_share) * settings.tracking.max_velocity),
        kappa_(settings.tracking.kappa),
        slowest_(limit_[0]),
        per_position_(T(1) / settings.reached_position),
        per_orientation_(T(1) / settings.reached_orientation) {
    for (const T& v : limit_)
      if (v < slowest_) slowest_ = v;
    check(settings);
  }
  [[nodiscard]] static SKINCTL_INLINE constexpr const JointControlSettings<N, T>& tracking(
      const Settings& s) noexcept {
    return s.tracking;
  }

  // Of plans.
  template <class J>
  [[nodiscard]] static SKINCTL_INLINE const Where& where(const Site<J>& at) noexcept {
    return at.X_BP;
  }
  // Of laws.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto site(const K& known) const noexcept {
    return site_of(known.q(), known.dq(), known.template jacobian<Ix>(X_LP_),
                   known.template pose<Ix>() * X_LP_);
  }
  template <class M>
  [[nodiscard]] SKINCTL_INLINE auto site(const M& model, const JointPosition<N, T>& q,
                                         const JointVelocity<N, T>& dq) const noexcept {
    constexpr LinkMask mask = ancestors<M>(Ix);
    const Poses<M, mask, T> poses(model, JointAngles<M, T, mask>(model, q));
    return site_of(q, dq, jacobian<Ix>(poses, X_LP_), poses.template get<Ix>() * X_LP_);
  }
  template <class J>
  [[nodiscard]] static Errors errors(const Reference& target, const Site<J>& at,
                                     const Memory& memory) noexcept {
    return task_errors(target, at, memory).in_lanes.stored();
  }
  /// The sliding surface and the reference motion of the joints, eqs. (15)-(21).
  template <class Gains, class J>
  [[nodiscard]] SKINCTL_NOINLINE Surface surface(const Gains& gains, const Inputs& in, const Site<J>& at,
                                                 const Memory& memory) const noexcept {
    Surface s;
    const auto error = task_errors(in.target, at, memory);
    s.branch = error.branch;
    const auto x = sliding_surface(gains, in, error.in_lanes,
                                   [](const auto&) { return JointVelocity<coordinates, T>(); });
    s.S_delta = x.S_delta, s.dI1 = x.dI1, s.dI2 = x.dI2, s.dx_r = x.dq_r, s.ddx_r = x.ddq_r;

    Twist<P, Base, P, Base, T> v{get(x.dq_r.data), {}};
    Acceleration<P, Base, P, Base, T> a{get(x.ddq_r.data), {}};
    if constexpr (What == TaskSpace::pose) {
      const auto map = Orientation::map(at.X_BP.axes(), at.V.angular, memory.branch);
      v.angular = map.omega(get(x.dq_r.data + 3));
      a.angular = map.domega(get(x.dq_r.data + 3), get(x.ddq_r.data + 3));
    }
    const DampedInverse<J, What> inverse(at.jacobian, singularities_, [&] {
      const T speed2 = dot(v.linear, v.linear) + dot(v.angular, v.angular);
      const T rate = T(2) * (dot(v.linear, a.linear) + dot(v.angular, a.angular));
      return singularities_.scaled(min_damping_, speed2, rate, slowest_);
    });
    const T nearness = inverse.nearness();
    if constexpr (Null::rests) {
      s.dq_r = inverse.solve(v);
      s.ddq_r = inverse.solve_rate(at.dq, at.V, v, a, s.dq_r);
    } else {
      v = v - at.V;
      a = a - jacobian_rate_times(at.jacobian, at.dq, at.dq, at.V);
      const auto dq = inverse.solve(v);
      s.ddq_r = inverse.solve_rate(at.dq, at.V, v, a, dq);
      s.dq_r = at.dq + dq;
    }
    s.rests = false;
    if (nearness > T(0)) [[unlikely]] {
      rest(in, at, error.in_lanes.stored(), memory.rest, nearness, s);
      if (!s.rests) s.way_out = memory.escape.template wish<What>(at.jacobian, v, limit_);
    }
    using R = detail::Row<N, T>;
    R dq_r = R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return s.dq_r[i]; }) + memory.escape.v;
    R ddq_r = R::of([&](auto i) SKINCTL_INLINE_LAMBDA { return s.ddq_r[i]; }) + memory.escape.a;
    s.slowed = nearness > T(0);
    s.slowed |= limit_speed(limit_, dq_r, ddq_r);
    const R drift = memory.drift;
    dq_r = dq_r + drift;
    ddq_r = ddq_r - kappa_ * drift;
    dq_r.store(s.dq_r);
    ddq_r.store(s.ddq_r);
    (at.dq - dq_r).store(s.S_q);
    return s;
  }
  /// The joints' velocity `J^+ x` for the velocity `x` of the coordinates; with the largest damping in the
  /// zone.
  template <class J>
  [[nodiscard]] SKINCTL_NOINLINE JointVelocity<N, T> joint_speed(const JointVelocity<coordinates, T>& x,
                                                                 const Site<J>& at,
                                                                 const Memory& memory) const noexcept {
    Twist<P, Base, P, Base, T> v{get(x.data), {}};
    if constexpr (What == TaskSpace::pose)
      v.angular = Orientation::map(at.X_BP.axes(), at.V.angular, memory.branch).omega(get(x.data + 3));
    return DampedInverse<J, What>(at.jacobian, singularities_).solve(v);
  }
  template <class J>
  static void rows(const Site<J>& at, T (&rows)[coordinates][N]) noexcept {
    static_assert(!std::same_as<Orientation, ZyzError>, "a moment has no component along an angle's rate");
    for (auto& row : rows)
      for (T& x : row) x = T(0);
    at.jacobian.for_each([&](auto i, const auto& c) {
      const T six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
      for (std::size_t r = 0; r < coordinates; ++r) rows[r][i.value] = six[r];
    });
  }
  template <class J>
  static void follow_branch(Memory& memory, const Reference& target, const Site<J>& at) noexcept {
    const Xyz<T> branch = task_errors(target, at, memory).branch;
    const T sum = dot(branch, branch);
    if (sum - sum == T(0)) memory.branch = branch;
  }
  [[nodiscard]] static SKINCTL_INLINE Course course(const Surface& s) noexcept { return {s.dx_r, s.ddx_r}; }
  [[nodiscard]] Memory advanced(const Memory& memory, const Surface& s, const T& dt) const noexcept {
    Memory next = memory;
    const T sum = dot(s.branch, s.branch);
    if (sum - sum == T(0)) next.branch = s.branch;
    next.slowed = s.slowed;
    const T stays = T(1) / (T(1) + kappa_ * dt);
    const detail::Row<N, T> drift = next.drift;
    select(magnitude(drift) > T(detail::smallest_motion), stays * drift, T(0)).store(next.drift);
    next.escape = memory.escape.advanced(s.way_out, dt);
    next.rest = memory.rest.advanced(s.rests, s.q, dt);
    return next;
  }
  /// Takes over the velocity by which joints are `faster` than the reference, which does not follow them next
  /// to a singularity or above their limits. This difference decays as S_d does.
  static SKINCTL_INLINE void take_up(Memory& memory, const JointVelocity<N, T>& faster) noexcept {
    for (std::size_t i = 0; i < N; ++i) memory.drift[i] = faster[i] - faster[i] == T(0) ? faster[i] : T(0);
  }
  /// The memory after a reset: the orientation error is the shortest rotation.
  [[nodiscard]] static SKINCTL_INLINE Memory renewed(Memory memory) noexcept {
    memory.branch = {T(0), T(0), T(0)};
    return memory;
  }
  [[nodiscard]] static SKINCTL_INLINE Status status(const Memory& memory) noexcept {
    return memory.slowed ? Status(Reason::slowed) : Status();
  }

 private:
  template <class J>
  [[nodiscard]] static SKINCTL_INLINE Site<J> site_of(const JointPosition<N, T>& q,
                                                      const JointVelocity<N, T>& dq, const J& jacobian,
                                                      const Where& X_BP) noexcept {
    return {q, dq, jacobian, X_BP, jacobian * dq};
  }
  /// Holds the joints at a goal that stands still and is reached, next to a singularity: see `SingularRest`.
  template <class J>
  SKINCTL_COLD void rest(const Inputs& in, const Site<J>& at, const Errors& error,
                         const SingularRest<N, T>& rest, const T& nearness, Surface& s) const noexcept {
    const auto square = [](const Xyz<T>& x) { return dot(x, x); };
    T far = per_position_ * per_position_ * square(get(error.e)), speed = square(in.target.V.linear);
    if constexpr (What == TaskSpace::pose) {
      far = far + per_orientation_ * per_orientation_ * square(get(error.e + 3));
      speed = speed + square(in.target.V.angular);
    }
    for (const T& v : in.bias.S_d) speed = speed + v * v;  // of a robot that moved when its goal came
    s.rests = rest.reached(far, speed);
    s.q = at.q;
    if (!(rest.r > T(0))) return;
    const typename SingularRest<N, T>::template Directions<What, J> directions(at.jacobian, nearness);
    rest.hold(directions, at.q, at.dq, in.K_p.K, s.dq_r, s.ddq_r);
    for (auto* rate : {&s.dI1, &s.dI2}) {
      Twist<P, Base, P, Base, T> v{get(rate->data), {}};
      if constexpr (What == TaskSpace::pose) v.angular = get(rate->data + 3);
      const auto held = directions.of_frame(v);
      put(rate->data, v.linear - rest.r * held.linear);
      if constexpr (What == TaskSpace::pose) put(rate->data + 3, v.angular - rest.r * held.angular);
    }
  }
  using Row = detail::Row<coordinates, T>;
  /// The errors, and the branch of the orientation error.
  struct TaskErrors {
    SurfaceErrorRows<coordinates, T> in_lanes;
    Xyz<T> branch;
  };
  /// A row of coordinates: linear, then angular.
  static SKINCTL_INLINE Row row(const Xyz<T>& linear, const Xyz<T>& angular) noexcept {
    return Row::of([&](auto i) SKINCTL_INLINE_LAMBDA {
      const Xyz<T>& three = i < 3 ? linear : angular;
      return i % 3 == 0 ? three.x : (i % 3 == 1 ? three.y : three.z);
    });
  }
  template <class J>
  static SKINCTL_INLINE TaskErrors task_errors(const Reference& target, const Site<J>& at,
                                               const Memory& memory) noexcept {
    const Xyz<T> de = at.V.linear - target.V.linear;
    OrientationErrors<T> turned{{}, {}, {}, {}, {}, memory.branch};
    if constexpr (What == TaskSpace::pose)
      turned = Orientation::errors(
          at.X_BP.axes(), at.V.angular,
          RotationReference<T>{target.X_BP.axes(), target.V.angular, target.A.angular}, memory.branch);
    return {{row(at.X_BP.origin() - target.X_BP.origin(), turned.e), row(de, turned.de),
             row(de, turned.slope), row(target.V.linear, turned.v_d), row(target.A.linear, turned.a_d)},
            turned.branch};
  }

  Transform<Link<Ix>, P, T> X_LP_;
  T min_damping_;
  SingularityDamping<T> singularities_;
  static constexpr double reference_share = 0.99;  ///< share of a joint's speed that a reference may ask for

  JointVelocity<N, T> limit_;  ///< largest reference speed [rad/s]: a hundredth is left for overshoot
  T kappa_;                    ///< decay rate of `Memory::drift` [1/s]
  T slowest_;                  ///< smallest element of `limit_` [rad/s]
  T per_position_;             ///< one over the tolerance of a reached position [1/m]
  T per_orientation_;
};

SKINCTL_END_NAMESPACE
