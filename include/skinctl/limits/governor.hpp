// Slows a command down for limits that concern the whole robot: jerk, tool speed, clearance, contact.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/limits/detail/governor_parts.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A command that a governor passed or slowed; `altered` is true if it was slowed.
template <std::size_t N, Real T>
struct Governed {
  JointCommand<N, T> command;
  Status status;
  bool altered = false;
};

/// In place of a governor in a scene without one: no code, no memory.
struct NoGovernor {
  struct Memory {
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };
};

/// The same of a torque; `hold` is the torque that holds the robot if the guard refuses the command.
template <std::size_t N, Real T>
struct GovernedTorque : Governed<N, T> {
  JointTorque<N, T> hold;
};

/// The stage between resolver and guard of a scene. `make_governor` builds it from those of `JerkLimits`,
/// `ToolSpeed`, `ClearanceLimits`, `ContactLimits` and `CoverageLimits` that the scene has; the others cost nothing.
///
/// **Positions and velocities.** A command within the limits passes to the bit. Otherwise all joints are
/// slowed alike (contact, tool), a motion from the last command to the slowed one is computed within the
/// limits of the joints (and of jerk), and the resolver learns what was sent: its virtual robot goes on from
/// there, so nothing is caught up later. With a limit of jerk every command is computed anew, except while the robot
/// stops or is held: then the resolver's own braking passes, and jerk gives way.
///
/// Where the limits conflict, the last in this order gives way first: acceleration, position, velocity of the
/// joints; clearances; the tool's speed; jerk; contact (for a person who steps in the robot brakes as hard as the other
/// limits allow, and the guard stops at excess force or power).
///
/// **Torques.** The motion under external forces is unknown, so the speed is braked: `braking_cycles` cycles
/// ahead, after T, the torque leads to `u = dq + T M^-1 (tau - hold)`, of which a share s keeps all limits.
/// `tau - (1 - s) M u / T` leads to s u: drive that would make the robot too fast, or press harder than a
/// region allows, is removed, and a robot that is pushed too fast is damped; with `MotionLimits`, what pushes it (their r)
/// counts as well for the tool's speed and the clearances. It sets in without a jump (s = 1
/// leaves the torque to the bit), and never exceeds the joints' torques. A robot stopped for a contact is
/// held with damping `M / T`. There is no limit of jerk.
template <std::size_t N, Real T, class Jerk, class Tool, class Contact, class Range = detail::NoPart,
          class Watch = detail::NoPart, class Clear = detail::NoPart>
class Governor : public detail::GovernorParts<N, T, Jerk, Tool, Contact, Range, Watch, Clear> {
  using Parts = detail::GovernorParts<N, T, Jerk, Tool, Contact, Range, Watch, Clear>;

 public:
  using Parts::braking_cycles;
  using Parts::has_clearance;
  using Parts::has_contact;
  using Parts::has_jerk;
  using Parts::has_motion;
  using Parts::has_tool;
  using Parts::has_watch;

  /// Trivially copyable.
  struct Memory : Parts::Memory {
    JointAcceleration<N, T> acceleration;  ///< at the end of the last command
    JointPosition<N, T> position, carry;   ///< the last command's position, and its rounding error
  };

  SKINCTL_COLD Governor(const JointLimits<N, T>& limits, const Jerk& jerk, const Tool& tool,
                        const Contact& contact, const Range& motion = Range(), const Watch& watch = Watch(),
                        const Clear& clearance = Clear())
      : Parts(limits, jerk, tool, contact, motion, watch, clearance) {}

  /// The command in place of `wish`, `dt` > 0 seconds after `last` was sent.
  ///
  /// @param measured  the last good state of the robot.
  /// @param touch     the contacts: `PressedAreas`, or wrenches on the links.
  /// @param nearest   strongest proximity reading for each link of the contact limits; both are read only
  ///                  with contact limits.
  /// @param hard      whether jerk gives way, see `Resolver::stops_or_corrects`.
  /// @param stops     whether a stop was requested: it ends at a clearance, and does not slide along.
  /// A `wish` that is not valid, not finite, or far from any robot passes: the guard refuses it.
  template <class Touch, class Nearest>
  SKINCTL_INLINE Governed<N, T> step(Memory& m, const JointCommand<N, T>& last,
                                     const JointCommand<N, T>& wish, const State<N, T>& measured,
                                     const Touch& touch, const Nearest& nearest, const T& dt,
                                     bool hard = false, bool stops = false) const noexcept {
    Governed<N, T> out{wish.copy(), {}, false};
    if (!last.valid || !wish.valid || !detail::is_plausible(wish) || !(dt > T(0))) {
      m.acceleration = {};
      return out;
    }
    detail::Slowed<N, T> left = this->felt(m, measured, wish.velocity, touch, nearest, dt);
    const auto room = limits_.room(last.position);
    this->keep_tool_speed(last.position, room, last.velocity, dt, left);
    this->keep_clear(m, last.position, room, last.velocity, dt, left, !stops);
    out.status |= left.status;
    if constexpr (has_jerk) {
      if (hard) [[unlikely]] {
        // Jerk is limited again from no acceleration on: that of hard braking would lead beyond rest.
        if (left.slowed) follow<false>(m, last, left.velocity, dt, out);
        m.acceleration = {};
      } else {
        const auto motion = jerk_.move(room, last.velocity, m.acceleration, left.velocity, dt);
        // A jerk limit that would make the tool too fast, or bring links too close, gives way.
        const Status broken = this->broken(m, last.position, room, motion.velocity, motion.displacement);
        if (broken.any()) {
          out.status |= broken;
          follow<false>(m, last, left.velocity, dt, out);
        } else {
          out.status |= motion.status;
          m.acceleration = motion.acceleration;
          make(m, last, motion, dt, out);
        }
      }
      out.status |= exceeded(last, out.command, dt);
    } else if (left.slowed) {
      const auto motion = limits_.move(room, last.velocity, left.velocity, dt);
      out.status |= motion.status.without(Reason::acceleration_limited);
      make(m, last, motion, dt, out);
    }
    return out;
  }

  /// The torque in place of `wish.torque`, `dt` > 0 seconds after the last one was sent.
  ///
  /// @param hold      the torque that holds the robot: gravity compensation, with friction if it has some.
  /// @param stopping  whether the guard waits for consent: then hold with damping.
  /// @param stale     whether the measured velocity is too old to brake by: then the wish passes.
  /// @param rate      fastest change of a torque that the guard allows: see `MotionLimits`.
  /// The other parameters are those of `step`.
  template <class Touch, class Nearest>
  SKINCTL_NOINLINE GovernedTorque<N, T> step_torque(Memory& m, const JointCommand<N, T>& last,
                                                    const JointCommand<N, T>& wish,
                                                    const JointTorque<N, T>& hold, bool stopping, bool stale,
                                                    const T& rate, const State<N, T>& measured,
                                                    const Touch& touch, const Nearest& nearest,
                                                    const T& dt) const noexcept {
    static_assert(!has_jerk, "a torque interface has no motion whose jerk could be limited");
    GovernedTorque<N, T> out{{wish, {}, false}, hold};
    if (stale || !wish.valid || !detail::is_plausible(wish) || !detail::is_finite(hold) || !(dt > T(0))) {
      if constexpr (has_motion) m.motion.known = false;
      return out;
    }
    const JointAngles<std::remove_cvref_t<decltype(model())>, T> angles(model(), measured.q);
    const auto mass = mass_matrix(model(), angles);
    T ahead = T(braking_cycles) * dt;
    // A guard turns a torque over its whole range in 20 ms: at high rates braking begins earlier than that.
    if (has_motion && ahead < T(0.01)) ahead = T(0.01);
    const JointTorque<N, T> asked = limits_.within(wish.torque, measured.dq);
    JointTorque<N, T> braked = asked;
    [[maybe_unused]] JointTorque<N, T> bias;
    if constexpr (has_motion) {
      bias = bias_torque(model(), angles, measured.dq);
      motion_.observe(m.motion, mass, bias, measured, last.torque, dt);
    }
    if constexpr (has_contact || has_watch || has_tool || has_clearance) {
      const math::Ldlt<N, T> factors(mass.data);
      if (!factors.positive_definite()) return out;
      const auto lead_to = [&](const JointVelocity<N, T>& from, const JointTorque<N, T>& net) {
        JointAcceleration<N, T> given;
        factors.solve(net.data, given.data);
        return integrate(from, given, ahead);
      };
      JointTorque<N, T> drive = asked - limits_.within(hold, measured.dq);
      if constexpr (has_motion) drive -= coriolis_torque(model(), angles, measured.dq);
      JointVelocity<N, T> u = lead_to(measured.dq, drive), kept = u;
      if constexpr (has_contact) {
        const auto verdict = contact_.look(m.contact, measured, u, touch, contact_.distances(nearest), dt);
        out.status |= verdict.status;
        if (verdict.scale < T(1)) kept = verdict.scale * u;
        stopping = stopping || out.status.has(Reason::contact_force) || out.status.has(Reason::contact_power);
      }
      // What the world does beside the torque: not for a contact, whose force it would hide.
      if constexpr (has_motion && (has_tool || has_clearance)) {
        const JointVelocity<N, T> world = lead_to({}, T(-1) * motion_.resistance(m.motion));
        u += world, kept += world;
      }
      T share(1);
      if constexpr (has_watch) {
        const T slow = watch_.share(m.watch, kept);
        if (slow < share) share = slow;
      }
      if constexpr (has_tool) {
        const T tool = tool_.share(measured.q, kept, ahead);
        if (tool < T(1)) out.status |= Reason::tool_speed_limited;
        if (tool < share) share = tool;
      }
      if (share < T(1)) kept = share * kept;
      if constexpr (has_clearance) {
        const auto clear = clearance_.braked(m.around, measured.q, kept, ahead);
        if (clear.limited) out.status |= Reason::clearance_kept;
        kept = clear.velocity;
      }
      if (!(kept == u)) {
        braked = asked - momentum_of<AllJoints<N>>(mass, u - kept) * T(T(1) / ahead);
        out.altered = true;
      }
    }
    if constexpr (has_motion) {
      const auto within =
          motion_.within(m.motion, limits_, mass, bias, measured, last.torque, braked, ahead, dt, rate);
      out.status |= within.status;
      if (within.altered) braked = within.torque, out.altered = true;
    }
    if (out.altered) out.command.torque = limits_.within(braked, measured.dq);
    if (stopping)
      out.hold =
          limits_.within(hold - momentum_of<AllJoints<N>>(mass, measured.dq) * T(T(1) / ahead), measured.dq);
    return out;
  }

  /// The motion from `last` towards the velocity `u` within the limits of the joints, and of jerk if `Smooth`;
  /// `out.command` becomes the command at its end, `dt` > 0 seconds after `last`.
  template <bool Smooth = has_jerk>
  SKINCTL_INLINE void follow(Memory& m, const JointCommand<N, T>& last, const JointVelocity<N, T>& u,
                             const T& dt, Governed<N, T>& out) const noexcept {
    const auto room = limits_.room(last.position);
    if constexpr (Smooth) {
      const auto motion = jerk_.move(room, last.velocity, m.acceleration, u, dt);
      out.status |= motion.status;
      m.acceleration = motion.acceleration;
      make(m, last, motion, dt, out);
    } else {
      const auto motion = limits_.move(room, last.velocity, u, dt);
      out.status |= motion.status.without(Reason::acceleration_limited);
      if constexpr (has_jerk)
        for (std::size_t i = 0; i < N; ++i) m.acceleration[i] = (motion.velocity[i] - last.velocity[i]) / dt;
      make(m, last, motion, dt, out);
    }
  }

  /// `jerk_exceeded`, if the acceleration has changed faster than the limit allows.
  [[nodiscard]] SKINCTL_INLINE Status exceeded(const JointCommand<N, T>& last,
                                               const JointCommand<N, T>& command, const T& dt) const noexcept
    requires has_jerk
  {
    using R = detail::Row<N, T>;
    const R change = R(command.acceleration) - last.acceleration, most = R(jerk_.jerk()) * R(dt);
    const R rounding = T(16) * std::numeric_limits<T>::epsilon() * R(limits_.acceleration());
    return any(magnitude(change) > most + rounding) ? Status(Reason::jerk_exceeded) : Status();
  }

  /// The guard sent `command` instead.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<N, T>& command) const noexcept {
    if constexpr (has_jerk) m.acceleration = command.acceleration;
  }

 private:
  [[nodiscard]] SKINCTL_INLINE const auto& model() const noexcept {
    if constexpr (has_contact) {
      return contact_.model();
    } else if constexpr (has_tool) {
      return tool_.model();
    } else if constexpr (has_clearance) {
      return clearance_.model();
    } else {
      return motion_.model();
    }
  }
  template <class Motion>
  SKINCTL_INLINE void make(Memory& m, const JointCommand<N, T>& last, const Motion& motion, const T& dt,
                           Governed<N, T>& out) const noexcept {
    if (!(m.position == last.position)) m.carry = {};
    for (std::size_t i = 0; i < N; ++i) {
      const T q = last.position[i], step = motion.displacement[i] + m.carry[i];
      const T lower = limits_.lower()[i], upper = limits_.upper()[i];
      T next = q + step;
      m.carry[i] = step - (next - q);
      if (next > upper && q <= upper) next = upper, m.carry[i] = T(0);
      if (next < lower && q >= lower) next = lower, m.carry[i] = T(0);
      out.command.position[i] = m.position[i] = next;
      out.command.velocity[i] = motion.velocity[i];
      if constexpr (requires { motion.acceleration; }) {
        out.command.acceleration[i] = motion.acceleration[i];  // at its end: the guard may brake from there
      } else {
        out.command.acceleration[i] = (motion.velocity[i] - last.velocity[i]) / dt;
      }
    }
    out.altered = true;
  }

  using Parts::clearance_;
  using Parts::contact_;
  using Parts::jerk_;
  using Parts::limits_;
  using Parts::motion_;
  using Parts::tool_;
  using Parts::watch_;
};

/// A governor from its parts, in any order; `limits` are those of resolver and guard.
template <std::size_t N, Real T, class... Parts>
[[nodiscard]] auto make_governor(const JointLimits<N, T>& limits, const Parts&... parts) {
  static_assert(sizeof...(Parts) > 0, "a governor without parts: leave it out of the cycle");
  detail::check_parts<Parts...>();
  return detail::with_parts(
      [&]<class... P>(const P&... given) { return Governor<N, T, P...>(limits, given...); }, parts...);
}

SKINCTL_END_NAMESPACE
