// The space in which Operational Control tracks: the pose of a tool, section 4.2.2.
#pragma once

#include "skinctl/control/null_space.hpp"
#include "skinctl/control/orientation_error.hpp"
#include "skinctl/control/sliding_surface.hpp"
#include "skinctl/control/speed_limit.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/kinematics/singular_direction.hpp"
#include "skinctl/trajectory/plan_clock.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of a tracking law in operational space.
template <std::size_t N, Real T = double>
struct OperationalSettings {
  /// Gains and times, as in joint space, of coordinates in metres and radians. `max_velocity` is the fastest
  /// that any joint is asked to go, next to a singularity too.
  JointControlSettings<N, T> tracking = {};
  T max_linear_velocity = T(0.5);      ///< of any motion to a goal [m/s]
  T max_angular_velocity = T(1.5);     ///< [rad/s]
  T max_linear_acceleration = T(1.5);  ///< after a reactive target [m/s^2]
  T max_linear_jerk = T(15);           ///< [m/s^3]
  T max_angular_acceleration = T(5);   ///< [rad/s^2]
  T max_angular_jerk = T(50);          ///< [rad/s^3]
  /// When J^+ is damped, and how much at most; as much as the joints' speed asks for.
  SingularityDamping<T> singularities = SingularityDamping<T>(T(0.01), T(0.08));
  T least_damping = T(0.02);  ///< l at a singularity where next to nothing is asked
};

/// Where a frame has to go, and in what time.
template <Frame P, Scalar T = double>
struct PoseGoal {
  Transform<Base, P, T> X_BP;
  Nanoseconds duration = 0;  ///< from the moment of reception; 0: as long as the speeds ask for
};

/// The pose of the frame `P`, fixed to link `I`, as the coordinates of a tracking law, eqs. (15)-(21): its
/// origin [m], then its orientation, or the origin alone.
///
/// `dq_r = J^+ dx_r`, with the damped inverse; `ddq_r` is its derivative, that of the damping included; `S_q
/// = dq - dq_r`, so that `J S_q = S_xdelta + K_i1 I1 + K_i2 I2` where nothing is damped or limited. Next to a
/// singularity the arm slows down (`Reason::slowed`).
///
/// @tparam What         `Task::pose` or `Task::position`.
/// @tparam Orientation  `RotationVectorError`, `QuaternionError` or `ZyzError`.
/// @tparam Null         `DampedNullSpace`, `FreeNullSpace` or `PostureNullSpace`: what joints do that the
///                      tool does not ask for.
template <std::size_t N, std::size_t I, Frame P = Tool, Real T = double, Task What = Task::pose,
          class Orientation = RotationVectorError, class Null = DampedNullSpace>
class OperationalSpace {
 public:
  static constexpr const char* name = "operational";                ///< of a law that follows targets in it
  static constexpr const char* spline_name = "spline_operational";  ///< of one that goes to goals
  static constexpr std::size_t joints = N;
  static constexpr std::size_t coordinates = What == Task::pose ? 6 : 3;
  static constexpr Needs needs = {.jacobians = link_bit<I>};
  using scalar = T;
  using Settings = OperationalSettings<N, T>;
  using Reference = PoseReference<P, T>;
  using Inputs = SurfaceInputs<coordinates, T, Reference>;
  using Errors = SurfaceErrors<coordinates, T>;
  using Where = Transform<Base, P, T>;
  using Goal = PoseGoal<P, T>;
  using Spline = PoseSpline<P, T>;

  struct Memory {
    Xyz<T> near{T(0), T(0), T(0)};   ///< branch of the orientation error
    JointVelocity<N, T> escape;      ///< motion out of a singularity that the damped inverse does not find
    JointAcceleration<N, T> rising;  ///< its derivative
    JointVelocity<N, T> drift;  ///< what the joints did at the start that the tool's course does not ask for
    bool slowed = false;        ///< next to a singularity, or at the largest speed of a joint
  };
  struct Surface {
    JointVelocity<coordinates, T> S_delta;  ///< eq. (19)
    JointVelocity<coordinates, T> dI1, dI2;
    JointVelocity<coordinates, T> dx_r;       ///< eq. (18)
    JointAcceleration<coordinates, T> ddx_r;  ///< its derivative
    JointVelocity<N, T> dq_r;                 ///< eq. (15)
    JointAcceleration<N, T> ddq_r;
    JointVelocity<N, T> S_q;
    JointVelocity<N, T> way_out;  ///< what `escape` goes to
    Xyz<T> near;                  ///< the branch of the orientation error
    bool slowed;
  };
  struct Course {
    const JointVelocity<coordinates, T>& v;
    const JointAcceleration<coordinates, T>& a;
  };
  /// What is read of a state: the tool's Jacobian, pose and velocity.
  template <class J>
  struct Site {
    const JointPosition<N, T>& q;
    const JointVelocity<N, T>& dq;
    J jacobian;
    Where X_BP;
    Twist<P, Base, P, Base, T> V;
  };

  /// @param X_LP  the frame in its link.
  explicit OperationalSpace(const Transform<Link<I>, P, T>& X_LP, const Settings& settings = {},
                            const Null& null = Null())
      : X_LP_(X_LP),
        least_damping_(settings.least_damping),
        singularities_(settings.singularities),
        limit_(settings.tracking.max_velocity),
        kappa_(settings.tracking.kappa),
        null_(null) {
    const auto positive = [](const char* what, const T& x) {
      require(x > T(0) && x <= T(1e6), what, static_cast<double>(x), "> 0");
    };
    slowest_ = limit_[0];
    for (const T& v : limit_)
      if (v < slowest_) slowest_ = v;
    positive("max_linear_velocity", settings.max_linear_velocity);
    positive("max_angular_velocity", settings.max_angular_velocity);
    check(PursuitLimits<T>{T(1), settings.max_linear_acceleration, settings.max_linear_jerk});
    check(PursuitLimits<T>{T(1), settings.max_angular_acceleration, settings.max_angular_jerk});
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
  [[nodiscard]] static SKINCTL_INLINE const Where& where_of(const Reference& r) noexcept { return r.X_BP; }
  [[nodiscard]] static SKINCTL_INLINE const Where& place(const Goal& goal) noexcept { return goal.X_BP; }
  [[nodiscard]] static Spline spline(const Where& from, const Where& to, const T& tf) noexcept {
    return {from, to, tf};
  }
  [[nodiscard]] static T shortest_time(const Where& from, const Goal& goal, const Settings& s) noexcept {
    const T way = detail::length(Xyz<T>(goal.X_BP.origin() - from.origin()));
    const T turn =
        What == Task::pose ? detail::length(log_so3(goal.X_BP.axes() * from.axes().transpose())) : T(0);
    const T a = shortest_spline_time(way, s.max_linear_velocity);
    const T b = shortest_spline_time(turn, s.max_angular_velocity);
    return a > b || !(a == a) ? a : b;
  }
  static void slow(Reference& r, const OwnTime<T>& own) noexcept {
    r.A = own.rate * own.rate * r.A +
          Acceleration<P, Base, P, Base, T>{own.bend * r.V.linear, own.bend * r.V.angular};
    r.V = own.rate * r.V;
  }
  [[nodiscard]] static Reference ahead(const Reference& r, const T& t) noexcept {
    const Xyz<T> v = r.V.linear + T(0.5) * t * r.A.linear;
    const Xyz<T> turn = t * (r.V.angular + T(0.5) * t * r.A.angular);
    return {Where::trusted(exp_so3(turn) * r.X_BP.axes(), r.X_BP.origin() + t * v),
            {r.V.linear + t * r.A.linear, r.V.angular + t * r.A.angular},
            r.A};
  }
  [[nodiscard]] static bool finite(const Reference& r) noexcept {
    const T sum = dot(r.X_BP.origin(), r.X_BP.origin()) + dot(r.V.linear, r.V.linear) +
                  dot(r.V.angular, r.V.angular) + dot(r.A.linear, r.A.linear) + dot(r.A.angular, r.A.angular);
    return sum - sum == T(0) && rotation_error(r.X_BP.axes()) <= tolerance<T>;
  }
  /// The same pose at constant velocity, or at rest.
  [[nodiscard]] static Reference drifting(const Reference& r) noexcept { return {r.X_BP, r.V, {}}; }
  [[nodiscard]] static Reference resting(const Reference& r) noexcept { return {r.X_BP, {}, {}}; }
  /// `r` moves on for `dt` towards a target, within the limits: its origin, and by the shortest turn.
  SKINCTL_COLD static void react(Reference& r, const Reference& target, const Settings& s,
                                 const T& dt) noexcept {
    const auto part = [&](const Xyz<T>& way, Xyz<T>& v, Xyz<T>& a, const Xyz<T>& v_t,
                          const PursuitLimits<T>& l) {
      Pursuit<3, T> three;
      put(three.v, v), put(three.a, a);
      T e[3], to[3], moved[3];
      put(e, way), put(to, v_t);
      three.advance(e, to, l, dt, moved);
      v = get(three.v), a = get(three.a);
      return get(moved);
    };
    const Xyz<T> p = part(target.X_BP.origin() - r.X_BP.origin(), r.V.linear, r.A.linear, target.V.linear,
                          {s.max_linear_velocity, s.max_linear_acceleration, s.max_linear_jerk});
    const Xyz<T> turn =
        part(log_so3(target.X_BP.axes() * r.X_BP.axes().transpose()), r.V.angular, r.A.angular,
             target.V.angular, {s.max_angular_velocity, s.max_angular_acceleration, s.max_angular_jerk});
    r.X_BP = Where::trusted(normalised(exp_so3(turn) * r.X_BP.axes()), r.X_BP.origin() + p);
  }
  [[nodiscard]] static bool allows(const Reference& r, const Settings& s) noexcept {
    const T sum =
        dot(r.X_BP.origin(), r.X_BP.origin()) + dot(r.A.linear, r.A.linear) + dot(r.A.angular, r.A.angular);
    return sum - sum == T(0) && rotation_error(r.X_BP.axes()) <= tolerance<T> &&
           detail::length(r.V.linear) < s.max_linear_velocity &&
           detail::length(r.V.angular) < s.max_angular_velocity;
  }
  [[nodiscard]] static Errors distance(const Reference& a, const Reference& b) noexcept {
    Errors error{};
    put(error.e, a.X_BP.origin() - b.X_BP.origin());
    if constexpr (What == Task::pose) put(error.e + 3, log_so3(a.X_BP.axes() * b.X_BP.axes().transpose()));
    return error;
  }
  [[nodiscard]] static T slowness(const Errors& error, const Settings& s) noexcept {
    const auto time = [&](std::size_t first, const T& fastest) {
      const T speed = fastest - detail::length(get(error.v_d + first));
      return speed > T(0) ? T(detail::length(get(error.e + first)) / speed) : T(0);
    };
    const T a = time(0, s.max_linear_velocity);
    if constexpr (What == Task::position) return a;
    const T b = time(3 % coordinates, s.max_angular_velocity);
    return b > a ? b : a;
  }

  // Of laws.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto site(const K& known) const noexcept {
    return site_of(known.q(), known.dq(), known.template jacobian<I>(X_LP_),
                   known.template pose<I>() * X_LP_);
  }
  template <class M>
  [[nodiscard]] SKINCTL_INLINE auto site(const M& model, const JointPosition<N, T>& q,
                                         const JointVelocity<N, T>& dq) const noexcept {
    constexpr LinkMask mask = ancestors<M>(I);
    const Poses<M, mask, T> poses(model, JointAngles<M, T, mask>(model, q));
    return site_of(q, dq, jacobian<I>(poses, X_LP_), poses.template get<I>() * X_LP_);
  }
  template <class J>
  [[nodiscard]] static Errors errors(const Reference& target, const Site<J>& at,
                                     const Memory& memory) noexcept {
    Errors error;
    Xyz<T> near;
    errors(error, near, target, at, memory);
    return error;
  }
  template <class Gains, class J>
  [[nodiscard]] SKINCTL_NOINLINE Surface surface(const Gains& gains, const Inputs& in, const Site<J>& at,
                                                 const Memory& memory) const noexcept;
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
    Errors error;
    Xyz<T> near;
    errors(error, near, target, at, memory);
    const T sum = dot(near, near);
    if (sum - sum == T(0)) memory.near = near;
  }
  [[nodiscard]] static SKINCTL_INLINE Course course(const Surface& s) noexcept { return {s.dx_r, s.ddx_r}; }
  [[nodiscard]] Memory advanced(const Memory& memory, const Surface& s, const T& dt) const noexcept {
    Memory next = memory;
    const T sum = dot(s.near, s.near);
    if (sum - sum == T(0)) next.near = s.near;
    next.slowed = s.slowed;
    const T stays = T(1) / (T(1) + kappa_ * dt);
    for (T& v : next.drift) v = detail::magnitude(v) > T(1e-30) ? T(stays * v) : T(0);
    // Two first-order lags of 50 ms, by backward Euler: smooth, and stable for every dt.
    const T w = T(1) / T(0.05);
    const T scale = T(1) / (T(1) + w * dt * (T(2) + w * dt));
    for (std::size_t i = 0; i < N; ++i) {
      const T rising = scale * (memory.rising[i] + w * w * dt * (s.way_out[i] - memory.escape[i]));
      if (!(rising - rising == T(0))) continue;
      next.rising[i] = rising;
      next.escape[i] = memory.escape[i] + dt * rising;
    }
    return next;
  }
  /// Takes over from joints that are `faster` than the reference asks for: next to a singularity, or above
  /// their limits, it does not follow them. The rest decays as S_d does.
  static SKINCTL_INLINE void take_up(Memory& memory, const JointVelocity<N, T>& faster) noexcept {
    for (std::size_t i = 0; i < N; ++i) memory.drift[i] = faster[i] - faster[i] == T(0) ? faster[i] : T(0);
  }
  /// After a reset: the shortest way round.
  [[nodiscard]] static SKINCTL_INLINE Memory renewed(Memory memory) noexcept {
    memory.near = {T(0), T(0), T(0)};
    return memory;
  }
  [[nodiscard]] static SKINCTL_INLINE Status status(const Memory& memory) noexcept {
    return memory.slowed ? Status(Reason::slowed) : Status();
  }

 private:
  static SKINCTL_INLINE void put(T* to, const Xyz<T>& v) noexcept { to[0] = v.x, to[1] = v.y, to[2] = v.z; }
  [[nodiscard]] static SKINCTL_INLINE Xyz<T> get(const T* x) noexcept { return {x[0], x[1], x[2]}; }
  template <class J>
  [[nodiscard]] static SKINCTL_INLINE Site<J> site_of(const JointPosition<N, T>& q,
                                                      const JointVelocity<N, T>& dq, const J& jacobian,
                                                      const Where& X_BP) noexcept {
    return {q, dq, jacobian, X_BP, jacobian * dq};
  }
  template <class J>
  static void errors(Errors& error, Xyz<T>& near, const Reference& target, const Site<J>& at,
                     const Memory& memory) noexcept {
    put(error.e, at.X_BP.origin() - target.X_BP.origin());
    put(error.de, at.V.linear - target.V.linear);
    put(error.slope, at.V.linear - target.V.linear);
    put(error.v_d, target.V.linear);
    put(error.a_d, target.A.linear);
    if constexpr (What == Task::pose) {
      const auto turned = Orientation::errors(
          at.X_BP.axes(), at.V.angular,
          RotationReference<T>{target.X_BP.axes(), target.V.angular, target.A.angular}, memory.near);
      put(error.e + 3, turned.e);
      put(error.de + 3, turned.de);
      put(error.slope + 3, turned.slope);
      put(error.v_d + 3, turned.v_d);
      put(error.a_d + 3, turned.a_d);
      near = turned.near;
    } else {
      near = memory.near;
    }
  }

  /// Where the asked motion is along the singular direction, and not out of the workspace, the joints turn
  /// along `v` by themselves, up to a quarter of their speed: the damped inverse alone would stay there.
  template <class J>
  [[nodiscard]] SKINCTL_COLD JointVelocity<N, T> way_out(const J& jacobian,
                                                         const Twist<P, Base, P, Base, T>& asked,
                                                         const JointVelocity<N, T>& escape) const noexcept {
    const auto d = singular_direction<What>(jacobian, escape);
    const T c = dot(d.u.linear, asked.linear) + dot(d.u.angular, asked.angular);
    const T size = detail::magnitude(c);
    const T left = T(1) - d.sigma * d.sigma / (T(0.03) * T(0.03));
    const T open = T(1) + (c < T(0) ? T(-d.bend) : d.bend) / T(0.02);
    if (!(left > T(0)) || !(open > T(0))) return {};
    const T gain = (c < T(0) ? T(-1) : T(1)) * T(0.25) * slowest_ * left * left *
                   (open < T(1) ? open : T(1)) * size / (size + T(0.02));
    return gain * d.v;
  }

  Transform<Link<I>, P, T> X_LP_;
  T least_damping_;
  SingularityDamping<T> singularities_;
  JointVelocity<N, T> limit_;
  T kappa_;    ///< decay of the drift
  T slowest_;  ///< of the limits
  [[no_unique_address]] Null null_;
};

/// Eqs. (15)-(21).
template <std::size_t N, std::size_t I, Frame P, Real T, Task What, class Orientation, class Null>
template <class Gains, class J>
SKINCTL_NOINLINE auto OperationalSpace<N, I, P, T, What, Orientation, Null>::surface(
    const Gains& gains, const Inputs& in, const Site<J>& at, const Memory& memory) const noexcept -> Surface {
  Surface s;
  Errors error;
  errors(error, s.near, in.target, at, memory);
  const auto x =
      sliding_surface(gains, in, error, [](const auto&) { return JointVelocity<coordinates, T>(); });
  s.S_delta = x.S_delta, s.dI1 = x.dI1, s.dI2 = x.dI2, s.dx_r = x.dq_r, s.ddx_r = x.ddq_r;

  Twist<P, Base, P, Base, T> v{get(x.dq_r.data), {}};
  Acceleration<P, Base, P, Base, T> a{get(x.ddq_r.data), {}};
  if constexpr (What == Task::pose) {
    const auto map = Orientation::map(at.X_BP.axes(), at.V.angular, memory.near);
    v.angular = map.omega(get(x.dq_r.data + 3));
    a.angular = map.domega(get(x.dq_r.data + 3), get(x.ddq_r.data + 3));
  }
  const T speed2 = dot(v.linear, v.linear) + dot(v.angular, v.angular);
  const T rate = T(2) * (dot(v.linear, a.linear) + dot(v.angular, a.angular));
  const auto inverse =
      damped_inverse<What>(at.jacobian, singularities_.scaled(least_damping_, speed2, rate, slowest_));
  const auto dJ = jacobian_rate(at.jacobian, at.dq);
  if constexpr (Null::rests) {
    s.dq_r = inverse.solve(v);
    s.ddq_r = inverse.solve_rate(dJ, v, a, s.dq_r);
  } else {
    const NullMotion<N, T> z = null_.motion(at.q, at.dq);
    v = v - at.jacobian * z.v;
    const auto J_a = at.jacobian * JointVelocity<N, T>::generate([&](std::size_t i) { return z.a[i]; });
    const auto dJ_v = dJ * z.v;
    a = {a.linear - J_a.linear - dJ_v.linear, a.angular - J_a.angular - dJ_v.angular};
    const auto dq = inverse.solve(v);
    s.ddq_r = z.a + inverse.solve_rate(dJ, v, a, dq);
    s.dq_r = z.v + dq;
  }
  const T nearness = inverse.nearness();
  if (nearness > T(0)) [[unlikely]]
    s.way_out = way_out(at.jacobian, v, memory.escape);
  s.dq_r += memory.escape;
  s.ddq_r += memory.rising;
  s.slowed = nearness > T(0);
  s.slowed |= limit_speed(limit_, s.dq_r, s.ddq_r);
  for (std::size_t i = 0; i < N; ++i) {
    s.dq_r[i] = s.dq_r[i] + memory.drift[i];
    s.ddq_r[i] = s.ddq_r[i] - kappa_ * memory.drift[i];
  }
  for (std::size_t i = 0; i < N; ++i) s.S_q[i] = at.dq[i] - s.dq_r[i];
  return s;
}

SKINCTL_END_NAMESPACE
