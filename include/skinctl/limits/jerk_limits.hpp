// Limits of jerk beside those of the joints: braking begins early enough to be smooth.
#pragma once

#include "skinctl/limits/detail/stopping.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The motion of joints over one step within limits of jerk: `acceleration` is that at its end, for the next
/// step.
template <std::size_t N, Real T = double>
struct SmoothMotion {
  JointPosition<N, T> displacement;
  JointVelocity<N, T> velocity;
  JointAcceleration<N, T> acceleration;
  Status status;
  std::uint64_t braked = 0;  ///< bit i: joint i was slowed because its room was too small
};

/// What `MaxJerk` limits: for `Cycle::without`.
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
      require(jerk[i] * T(1000) >= limits.acceleration()[i], "jerk limit", static_cast<double>(jerk[i]),
              ">= acceleration limit / 1000 s");
      // No state below the velocity limit travels further than this before it is at rest.
      const T V = limits.velocity()[i], A = limits.acceleration()[i];
      far_[i] = T(1.01) * (V * A / jerk[i] + detail::Stopping<T>(V, T(0), A, jerk[i]).reach().above);
    }
  }

  [[nodiscard]] const JointLimits<N, T>& joints() const noexcept { return limits_; }
  [[nodiscard]] const JointJerk<N, T>& jerk() const noexcept { return jerk_; }
  /// The same of the joints of a subset.
  template <class Set>
  [[nodiscard]] SKINCTL_COLD JerkLimits<Set::count, T> set() const {
    return {limits_.template part<Set>(), Set::of(jerk_)};
  }
  /// Throws `ConfigurationError` for a robot with a lead: it is extrapolated from velocities that are then smoothed,
  /// and the two swing.
  template <class Resolver>
  SKINCTL_COLD void check(const Resolver& robot) const {
    robot.each([&](auto k) {
      const T lead = robot.template parameters<k.value>().lead;
      require(lead == T(0), "lead beside MaxJerk", 1e3 * static_cast<double>(lead), "0 ms");
    });
  }
  /// `jerk_exceeded`, if the acceleration has changed from `before` to `now` in `dt` seconds faster than the limit
  /// allows.
  [[nodiscard]] SKINCTL_INLINE Status exceeded(const JointAcceleration<N, T>& before,
                                               const JointAcceleration<N, T>& now,
                                               const T& dt) const noexcept {
    using R = detail::Row<N, T>;
    const R change = R(now) - before, most = R(jerk_) * R(dt);
    const R rounding = T(16) * std::numeric_limits<T>::epsilon() * R(limits_.acceleration());
    return any(magnitude(change) > most + rounding) ? Status(Reason::jerk_exceeded) : Status();
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

  /// The same towards rest, by the quickest stop and without overshoot.
  [[nodiscard]] SKINCTL_COLD SmoothMotion<N, T> brake(const JointRoom<N, T>& room,
                                                      const JointVelocity<N, T>& u0,
                                                      const JointAcceleration<N, T>& a0,
                                                      const T& h) const noexcept {
    return each(room, u0, a0, h, [&](const Joint& joint, std::size_t, const T& u, const T& a) {
      return std::pair(Joint::without_dust(detail::Stopping<T>(u, a, joint.A, joint.J).after(h)), Status{});
    });
  }

 private:
  using Moved = detail::Moved<T>;

  /// One joint, its limits and its room.
  struct Joint {
    T V, A, J, above, below, slack;
    bool roomy;  ///< no end is near enough to matter in this step

    Joint(const T& v, const T& a, const T& j, const T& up, const T& down, const T& far) noexcept
        : V(v),
          A(a),
          J(j),
          above(up > T(0) ? up : T(0)),
          below(down > T(0) ? down : T(0)),
          slack(0),
          roomy(up > far && down > far) {
      if (roomy) [[likely]]
        return;
      const T both = up + down;
      slack = T(16) * eps() * (both <= std::numeric_limits<T>::max() ? both : T(V * V / A + V * A / J));
    }
    static T eps() noexcept { return std::numeric_limits<T>::epsilon(); }

    /// Whether the quickest stop stays between the ends, to within rounding.
    [[nodiscard]] bool can_rest(const T& u, const T& a) const noexcept {
      const auto reach = detail::Stopping<T>(u, a, A, J).reach();
      const T more = slack + T(256) * eps() * (reach.above + reach.below);
      return reach.above <= above + more && reach.below <= below + more;
    }
    /// Whether a step may end in this state: the same with a margin, and below the velocity limit.
    /// And the mean speed of its `h` seconds must not exceed that limit: an acceleration that changes its sign
    /// within the step may.
    [[nodiscard]] bool may_end(const Moved& m, const T& h) const noexcept {
      if (!(m.s <= V * h && -m.s <= V * h)) [[unlikely]]
        return false;
      if (roomy) [[likely]]
        return slow_enough(m);
      const T j = J * braking_share<T>;
      const auto reach = detail::Stopping<T>(m.u, m.a, T(A * braking_share<T>), j).reach();
      return reach.above <= above - m.s && reach.below <= below + m.s && slow_enough(m);
    }
    [[nodiscard]] bool slow_enough(const Moved& m) const noexcept {
      const T own = m.a * m.a / (T(2) * J * braking_share<T>);
      return (m.a > T(0) ? m.u : -m.u) + own <= V && m.u <= V && -m.u <= V;
    }
    /// Whether a step of constant jerk stays between the ends.
    [[nodiscard]] bool stays_inside(const T& u, const T& a, const T& j, const T& h) const noexcept {
      using std::sqrt;
      const T square = a * a - T(2) * j * u;  // it reverses where u + a t + j t^2/2 = 0
      if (!(square >= T(0))) return true;
      const T root = a < T(0) ? T(a - sqrt(square)) : T(a + sqrt(square));
      const T first = j != T(0) ? T(-root / j) : T(0), second = root != T(0) ? T(T(-2) * u / root) : T(0);
      for (const T t : {first, second}) {
        if (!(t > T(0) && t < h)) continue;
        const T s = Moved{T(0), u, a}.after(t, j).s;
        if (!(s <= above && -s <= below)) return false;
      }
      return true;
    }
    struct Bearable {
      T a;
      bool rests;
    };
    /// The acceleration nearest to `a` from which the joint can stop inside and below the velocity limit; in
    /// nearly all cases `a` itself.
    [[nodiscard]] Bearable bearable(const T& u, T a) const noexcept {
      using std::sqrt;
      if (roomy && slow_enough({T(0), u, a})) [[likely]]
        return {a, true};
      const T j = T(2) * J, more = V * (T(1) + T(256) * eps());
      const T up = more > u ? T(sqrt(j * (more - u))) : T(0),
              down = more > -u ? T(sqrt(j * (more + u))) : T(0);
      a = a > up ? up : (a < -down ? -down : a);
      if (can_rest(u, a)) [[likely]]
        return {a, true};
      const T hardest = detail::Stopping<T>(u, a, A, J).reach().above > above ? T(-A) : A;
      if (!can_rest(u, hardest)) return {hardest, false};
      T good = hardest, bad = a;
      for (int k = 0; k < std::numeric_limits<T>::digits; ++k) {
        const T middle = T(0.5) * (good + bad);
        (can_rest(u, middle) ? good : bad) = middle;
      }
      return {good, true};
    }

    /// `a` within the acceleration limit, 0 if it is NaN.
    [[nodiscard]] T within_acceleration(const T& a) const noexcept {
      return a == a ? (a > A ? A : (a < -A ? T(-A) : a)) : T(0);
    }

    [[nodiscard]] std::pair<Moved, Status> move(const T& u, const T& a, const T& target,
                                                const T& h) const noexcept {
      Status status;
      const T wish = target == target ? (target > V ? V : (target < -V ? -V : target)) : T(0);
      if (wish != target) status |= Reason::velocity_limited;
      const T asked = (wish - u) / h, most = a + J * h, least = a - J * h;
      T a1 = asked > A ? A : (asked < -A ? -A : asked);
      if (a1 != asked) status |= Reason::acceleration_limited;
      const T before = a1;
      a1 = a1 > most ? most : (a1 < least ? least : a1);
      if (a1 != before) status |= Reason::jerk_limited;
      const T slope = (a1 - a) / h;
      Moved m = Moved{T(0), u, a}.after(h, slope);
      m.a = a1;
      if (!may_end(m, h) || (!roomy && !stays_inside(u, a, slope, h))) [[unlikely]] {
        const bool slow = slow_enough(m) && m.s <= V * h && -m.s <= V * h;
        status |= slow ? Reason::position_limited : Reason::velocity_limited;
        const Moved brake = detail::Stopping<T>(u, a, A, J).after(h);
        Moved kept = brake;
        if (roomy ||
            stays_inside(u, a, slope, h)) {  // as much of the step as possible: both parts keep all limits
          T good = T(0), bad = T(1);
          for (int k = 0; k < 24; ++k) {
            const T part = T(0.5) * (good + bad);
            const Moved mixed{brake.s + part * (m.s - brake.s), brake.u + part * (m.u - brake.u),
                              brake.a + part * (m.a - brake.a)};
            const bool may = may_end(mixed, h);
            if (may) kept = mixed;
            (may ? good : bad) = part;
          }
        }
        m = kept;
      }
      return {without_dust(m), status};
    }
    /// Without speeds and accelerations whose squares are denormal numbers.
    [[nodiscard]] static Moved without_dust(Moved m) noexcept {
      const T tiny = T(std::same_as<T, float> ? 1e-17 : 1e-150);
      if (m.u < tiny && -m.u < tiny) m.u = T(0);
      if (m.a < tiny && -m.a < tiny) m.a = T(0);
      return m;
    }
  };

  template <class Way>
  SKINCTL_INLINE SmoothMotion<N, T> each(const JointRoom<N, T>& room, const JointVelocity<N, T>& u0,
                                         const JointAcceleration<N, T>& a0, const T& h,
                                         Way&& way) const noexcept {
    SmoothMotion<N, T> out;
    for (std::size_t i = 0; i < N; ++i) {
      const Joint joint(limits_.velocity()[i], limits_.acceleration()[i], jerk_[i], room.above[i],
                        room.below[i], T(far_[i] + limits_.velocity()[i] * h));
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

/// For `Cycle::with`: the largest jerk of each joint [rad/s^3]. It limits the joints' motion and the guard's
/// braking. It gives way (`jerk_exceeded`) while the robot stops, and while a joint is farther from its command than the
/// dead band, as one that is held: the limits of acceleration, velocity and position are kept. A scene of a robot with
/// `lead` > 0 throws `ConfigurationError`.
template <std::size_t N, Real T = double>
struct MaxJerk {
  using Kind = JerkLimit;
  JointJerk<N, T> jerk;
};
template <std::size_t N, Real T>
MaxJerk(const JointJerk<N, T>&) -> MaxJerk<N, T>;

/// The limit of a robot that it makes.
template <class M, std::size_t J, Real S, std::size_t N, Real T>
[[nodiscard]] auto part_for(const M&, const JointLimits<J, S>& limits, const MaxJerk<N, T>& max) {
  static_assert(N == J, "MaxJerk: of a robot with another number of joints");
  return JerkLimits<N, T>(limits, max.jerk);
}

SKINCTL_END_NAMESPACE
