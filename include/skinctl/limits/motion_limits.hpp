// SPDX-License-Identifier: BSD-3-Clause
// Limits of position and speed for joints that take torques.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/joint_subset.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/limits/detail/beyond_end.hpp"
#include "skinctl/limits/detail/nearest_in_box.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/robot/detail/acted_torque.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The kind of the limits on the motion of joints by torque, for `Cycle::without`.
struct MotionByTorque {};

/// Position and velocity limits of the joints by torque, as a limit of a scene; one with such joints has it,
/// `without<MotionByTorque>()` takes it out.
///
/// The motion of these joints is not commanded, so the limits act on the velocity to which the torque leads
/// in a few cycles, `u = dq + t M^-1 (tau - C dq - G - r)`. Each joint has a largest u to either side: its
/// velocity limit, or the speed from which its acceleration limit stops it before its end. A joint that would
/// exceed it loses torque, and only such a joint does, and only towards the inside: the stops of
/// `nearest_in_box`. So the joints of a light finger do not turn each other, and above the limit a joint is
/// only braked. External forces beyond the joints' torques prevail.
///
/// Beyond an end a joint is held where it is, or at the end if it came from inside: by a spring on the way
/// out, as stiff as the braking damps it critically. It moves back inside freely, and the place with it, so
/// an arm that starts beyond an end does not move by itself. Above `hold_share` of its torque the place gives
/// way, as that of a stop does, and what pushes harder is braked to a creep.
///
/// r is the torque that resisted in the last cycles, the least of `tau - M ddq - C dq - G`: friction, or an
/// object in the hand. A joint that moves freely stays below its speed, one that holds something has its
/// whole torque. What pushes a joint on counts only above its limit: a touch is not resisted before. An
/// object that breaks sets free what r counted: the joint then exceeds its speed until its torque, turned
/// back by the guard at its rate, has braked it.
///
/// @tparam Set  the joints by torque.
template <RobotModel M, Real T = double, class Set = AllJoints<M::joints>>
class MotionLimits {
  static constexpr std::size_t n = Set::count;

 public:
  static constexpr std::size_t joints = M::joints;
  using Kind = MotionByTorque;
  static constexpr Precedence precedence = Precedence::torque;
  static constexpr bool limits_torque = true;
  using Torque = JointTorque<n, T>;

  /// Number of cycles of which the least resisting torque counts: it leaves out blows and noise.
  static constexpr int cycles = 3;
  /// The torques that resisted in the last cycles. Trivially copyable.
  struct Memory {
    JointVelocity<n, T> dq;                   ///< joint velocity in the last cycle [rad/s]
    Torque resists[cycles];                   ///< torques that resisted in the last cycles, newest first
    bool known = false;                       ///< whether `dq` and the places are those of the last cycle
    detail::BeyondEnd<T> below[n], above[n];  ///< where joints are held beyond their lower and upper ends
    detail::ActedTorque<n, T> sent;
  };
  /// The torque that keeps the limits, the velocity to which it leads, and the limits that acted.
  struct Kept {
    Torque torque;
    JointVelocity<n, T> u;
    Status status;
    bool altered = false;
  };

  explicit MotionLimits(const M& model) : model_(model) {}
  [[nodiscard]] const M& model() const noexcept { return model_; }

  /// Records, once a cycle, the torque that resisted the motors' torque, and where joints are held beyond
  /// their ends; other parameters as of `within`.
  ///
  /// @param delay  time from sending a torque until it acts [s].
  SKINCTL_INLINE void observe(Memory& m, const JointLimits<joints, T>& limits,
                              const MassMatrix<joints, T>& mass, const JointTorque<joints, T>& bias,
                              const State<joints, T>& measured, const Torque& last, const T& delay,
                              const T& ahead, const T& dt) const noexcept {
    const JointVelocity<n, T> dq = Set::of(measured.dq);
    for (int k = cycles - 1; k > 0; --k) m.resists[k] = m.resists[k - 1];
    m.resists[0] = {};
    Torque acted;
    if (m.sent.step(last, dt, delay, acted) && m.known) {
      const Torque gained = momentum_of<Set>(mass, measured.dq - whole(m.dq)), still = Set::of(bias);
      for (std::size_t i = 0; i < n; ++i) m.resists[0][i] = acted[i] - still[i] - gained[i] / dt;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = Set::index[i];
      const T q = measured.q[k], play = T(past_end) * limits.velocity()[k], limit = limits.torque()[k];
      m.below[i].observe(T(limits.lower()[k] - q), ahead, play, mass(k, k), limit, m.known);
      m.above[i].observe(T(q - limits.upper()[k]), ahead, play, mass(k, k), limit, m.known);
    }
    m.dq = dq;
    m.known = true;
  }
  /// Forgets the torques that resisted: a state was missing.
  static SKINCTL_INLINE void forget(Memory& m) noexcept { m.known = false; }
  /// Torque that resists the motor of each joint [N m]: the smallest in magnitude of the last three cycles, 0
  /// where its sign changed. Its sign is that of the motors' torque which it resists.
  [[nodiscard]] SKINCTL_INLINE Torque resistance(const Memory& m) const noexcept {
    Torque r;
    for (std::size_t i = 0; i < n; ++i) {
      const auto [least, most] = spread(m, i, T(1));
      r[i] = least > T(0) ? least : (most < T(0) ? most : T(0));
    }
    return r;
  }

  /// The bounds of the joints' velocities [rad/s]; `by_position[0]` and `[1]`: whether the lower and the
  /// upper one come from the joint's end, else from its velocity limit.
  struct Box {
    JointVelocity<n, T> lower, upper;
    bool by_position[2][n];
  };
  /// The bounds of the velocities to which torques lead `ahead` seconds later.
  [[nodiscard]] SKINCTL_INLINE Box box(const Memory& m, const JointLimits<joints, T>& limits,
                                       const State<joints, T>& measured, const T& ahead) const noexcept {
    const T reaction = detail::BeyondEnd<T>::lag(ahead);
    Box out;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = Set::index[i];
      const T V = limits.velocity()[k], a = limits.acceleration()[k],
              over = measured.q[k] - limits.upper()[k], under = limits.lower()[k] - measured.q[k];
      T above = speed_to_stop(T(-over), reaction, a), below = speed_to_stop(T(-under), reaction, a);
      // Held beyond the end, and on the way back not faster than the other end and the limit allow.
      if (m.known && over > T(0))
        above = detail::clamp(m.above[i].speed(over, ahead), below < V ? T(-below) : T(-V), T(0));
      if (m.known && under > T(0))
        below = detail::clamp(m.below[i].speed(under, ahead), above < V ? T(-above) : T(-V), T(0));
      out.by_position[0][i] = below < V;
      out.by_position[1][i] = above < V;
      out.lower[i] = below < V ? T(-below) : T(-V);
      out.upper[i] = above < V ? above : V;
    }
    return out;
  }

  /// The torques of the joints of `Set` nearest to `asked` that keep the limits.
  ///
  /// @param mass   M(q) of all joints; if it is not positive definite (a link without inertia, a NaN), the
  ///               motion cannot be predicted and the torque passes.
  /// @param bias   `C dq + G` of all joints.
  /// @param last   the torque that acted since the last cycle; `observe` comes first.
  /// @param ahead  the time t of the prediction [s].
  /// @param dt     seconds since the last cycle, > 0.
  /// @param rate   fastest change of a torque that the guard allows, in units of its limit per second. A
  ///               joint that cannot be braked as fast as it should be keeps what it has, and the others are
  ///               braked for that: cut afterwards, joint by joint, their torques would no longer suit each
  ///               other.
  [[nodiscard]] SKINCTL_NOINLINE Kept within(const Memory& m, const JointLimits<joints, T>& limits,
                                             const MassMatrix<joints, T>& mass,
                                             const JointTorque<joints, T>& bias,
                                             const State<joints, T>& measured, const Torque& last,
                                             const Torque& asked, const T& ahead, const T& dt,
                                             const T& rate) const noexcept {
    const JointVelocity<n, T> dq = Set::of(measured.dq);
    Kept out{asked, dq, {}, false};
    const auto& own = block_of<Set>(mass);
    auto [lower, upper, by_position] = box(m, limits, measured, ahead);
    Torque from, least, most;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = Set::index[i];
      const T limit = limits.torque()[k], step = rate * dt * limit;
      least[i] = detail::clamp(T(last[i] - step), T(-limit), limit);
      most[i] = detail::clamp(T(last[i] + step), T(-limit), limit);
      from[i] = detail::clamp(asked[i], least[i], most[i]);
    }
    const Torque still = Set::of(bias);
    Torque net = drive(m, limits, measured, from - still, lower, upper);
    const math::Ldlt<n, T> factors(own.data);
    if (!factors.positive_definite()) return out;
    for (std::size_t i = 0; i < n; ++i)
      detail::brake_return(T(ahead * net[i] / own(i, i)), lower[i], upper[i], by_position[0][i],
                           by_position[1][i]);
    const auto lead_to = [&] {
      JointAcceleration<n, T> given;
      factors.solve(net.data, given.data);
      return integrate(dq, given, ahead);
    };
    out.u = lead_to();
    bool keeps = true;
    for (std::size_t i = 0; i < n; ++i) keeps = keeps && out.u[i] >= lower[i] && out.u[i] <= upper[i];
    if (keeps) return out;
    bool again = true;
    for (int pass = 0; pass < passes && again; ++pass) {
      const auto bounded = detail::nearest_in_box(own, lead_to(), lower, upper);
      out.u = bounded.u;
      again = false;
      for (std::size_t i = 0; i < n; ++i) {
        const T p = bounded.impulse[i];
        const T torque = p > T(0) || p < T(0) ? T(from[i] - p / ahead) : from[i];
        out.torque[i] = detail::clamp(torque, least[i], most[i]);
        if (p > T(0) || p < T(0))
          out.status |= by_position[p > T(0)][i] ? Reason::position_limited : Reason::velocity_limited;
        if (out.torque[i] == torque) continue;
        net[i] += out.torque[i] - from[i];
        from[i] = out.torque[i];
        upper[i] = std::numeric_limits<T>::max();
        lower[i] = -upper[i];
        again = true;
      }
    }
    out.altered = true;
    return out;
  }

 private:
  /// Number of passes over the joints whose torque cannot change fast enough; one that is left brakes as it
  /// can.
  static constexpr int passes = 3;
  /// Share of the velocity limit over which the resisting torque sets in: a step would let it chatter.
  static constexpr double slowest = 1.0 / 128;
  /// Distance beyond a position limit up to which the resisting torque counts, over the velocity limit [s].
  static constexpr double past_end = 1e-3;

  [[nodiscard]] static SKINCTL_INLINE JointVelocity<joints, T> whole(
      const JointVelocity<n, T>& part) noexcept {
    JointVelocity<joints, T> out;
    Set::put(part, out);
    return out;
  }
  /// The smallest and largest torque that resisted joint `i` in the last cycles, times the side `to`, 1 or -1
  /// [N m]; > 0 resists motion to that side.
  [[nodiscard]] static SKINCTL_INLINE auto spread(const Memory& m, std::size_t i, const T& to) noexcept {
    struct {
      T least, most;
    } out{T(to * m.resists[0][i]), T(to * m.resists[0][i])};
    for (int k = 1; k < cycles; ++k) {
      const T r = to * m.resists[k][i];
      out.least = r < out.least ? r : out.least;
      out.most = r > out.most ? r : out.most;
    }
    return out;
  }
  /// The drive `d` > 0 of joint `i` to the side `to` less the torque that resists it, at least 0 [N m]; of a
  /// joint that is too fast and pushed on, with the torque that pushes it.
  ///
  /// Resistance is taken to grow with speed: of a joint that is too fast only the part counts that it would
  /// have at `bound`, or the joint would push on through friction beyond its end; and none of it `deepest`
  /// behind the end.
  ///
  /// @param bound   the largest speed to that side, `v` the present one, `V` the velocity limit [rad/s].
  /// @param beyond  the distance beyond the end [rad]; negative before it.
  [[nodiscard]] static SKINCTL_INLINE T left(const Memory& m, std::size_t i, const T& to, const T& d,
                                             const T& bound, const T& v, const T& V,
                                             const T& beyond) noexcept {
    const T may = bound > T(0) ? bound : T(0), excess = v - may, creep = T(slowest) * V,
            deepest = T(past_end) * V;
    const auto [least, most] = spread(m, i, to);
    if (most < T(0))  // it pushes on
      return excess > T(0) ? T(d - most * (excess < creep ? T(excess / creep) : T(1))) : d;
    if (!(least > T(0)) || beyond >= deepest) return d;
    T r = excess > T(0) ? T(least * ((may + creep) / (v + creep))) : least;
    if (beyond > T(0)) r = r * (T(1) - beyond / deepest);
    return d > r ? T(d - r) : T(0);
  }
  /// The drive `d` of each joint with what resists it or pushes it on; beyond `deepest` behind an end with
  /// what pushes more than is held.
  [[nodiscard]] SKINCTL_INLINE Torque drive(const Memory& m, const JointLimits<joints, T>& limits,
                                            const State<joints, T>& measured, const Torque& d,
                                            const JointVelocity<n, T>& lower,
                                            const JointVelocity<n, T>& upper) const noexcept {
    Torque net;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = Set::index[i];
      const T V = limits.velocity()[k], v = measured.dq[k], over = measured.q[k] - limits.upper()[k],
              under = limits.lower()[k] - measured.q[k], beyond = over > under ? over : under;
      net[i] = d[i] > T(0) ? left(m, i, T(1), d[i], upper[i], v, V, over)
                           : T(-left(m, i, T(-1), T(-d[i]), T(-lower[i]), T(-v), V, under));
      if (!(beyond > T(0))) continue;
      const T to = over > T(0) ? T(1) : T(-1), deepest = T(past_end) * V, creep = T(slowest) * V;
      const T share = beyond < deepest ? T(beyond / deepest) : T(1), push = -spread(m, i, to).most;
      const T more = detail::BeyondEnd<T>::prevails(push, T(to * v), creep, limits.torque()[k]);
      net[i] += share * (d[i] + to * more - net[i]);
    }
    return net;
  }

  [[no_unique_address]] M model_;
};

/// The motion of the joints by torque of `Set` stays within the limits of the joints: a part of each scene
/// that has such joints.
template <class Set>
struct WithinJointLimits {
  using Kind = MotionByTorque;
};
template <RobotModel M, Real T, class Set>
[[nodiscard]] auto part_for(const M& model, const JointLimits<M::joints, T>&, const WithinJointLimits<Set>&) {
  return MotionLimits<M, T, Set>(model);
}

SKINCTL_END_NAMESPACE
