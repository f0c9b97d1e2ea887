// Slows a command down for limits that concern the whole robot: jerk, tool speed, clearance, contact.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/limits/detail/parts.hpp"
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
/// there, so nothing is caught up later. With a limit of jerk every command is computed anew.
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
class Governor {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  using contact_type = Contact;
  static constexpr bool has_jerk = !std::is_same_v<Jerk, detail::NoPart>;
  static constexpr bool has_tool = !std::is_same_v<Tool, detail::NoPart>;
  static constexpr bool has_contact = !std::is_same_v<Contact, detail::NoPart>;
  static constexpr bool has_clearance = !std::is_same_v<Clear, detail::NoPart>;
  static constexpr bool has_surroundings = requires { requires Clear::around > 0; };
  static constexpr bool has_motion = !std::is_same_v<Range, detail::NoPart>;
  static constexpr bool has_watch = !std::is_same_v<Watch, detail::NoPart>;
  /// For torques: the number of cycles of the prediction, and of braking.
  static constexpr int braking_cycles = 4;

  /// Trivially copyable.
  struct Memory {
    JointAcceleration<N, T> acceleration;  ///< at the end of the last command
    JointPosition<N, T> position, carry;   ///< the last command's position, and its rounding error
    [[no_unique_address]] typename Contact::Memory contact;
    [[no_unique_address]] typename Watch::Memory watch;
    [[no_unique_address]] typename Range::Memory motion;
    [[no_unique_address]] typename Clear::Memory around;
  };

  SKINCTL_COLD Governor(const JointLimits<N, T>& limits, const Jerk& jerk, const Tool& tool,
                        const Contact& contact, const Range& motion = Range(), const Watch& watch = Watch(),
                        const Clear& clearance = Clear())
      : limits_(limits),
        jerk_(jerk),
        tool_(tool),
        contact_(contact),
        motion_(motion),
        watch_(watch),
        clearance_(clearance) {}

  [[nodiscard]] const JointLimits<N, T>& limits() const noexcept { return limits_; }
  [[nodiscard]] const Jerk& jerk() const noexcept { return jerk_; }
  [[nodiscard]] const Tool& tool() const noexcept { return tool_; }
  [[nodiscard]] const Contact& contact() const noexcept { return contact_; }
  [[nodiscard]] const Range& motion() const noexcept { return motion_; }
  [[nodiscard]] const Watch& watch() const noexcept { return watch_; }
  [[nodiscard]] const Clear& clearance() const noexcept { return clearance_; }

  /// The command in place of `wish`, `dt` > 0 seconds after `last` was sent.
  ///
  /// @param measured  the last good state of the robot.
  /// @param touch     the contacts: `PressedAreas`, or wrenches on the links.
  /// @param nearest   strongest proximity reading for each link of the contact limits; both are read only
  ///                  with contact limits.
  /// A `wish` that is not valid, not finite, or far from any robot passes: the guard refuses it.
  template <class Touch, class Nearest>
  SKINCTL_INLINE Governed<N, T> step(Memory& m, const JointCommand<N, T>& last,
                                     const JointCommand<N, T>& wish, const State<N, T>& measured,
                                     const Touch& touch, const Nearest& nearest, const T& dt) const noexcept {
    Governed<N, T> out{wish, {}, false};
    if (!last.valid || !wish.valid || !detail::is_plausible(wish) || !(dt > T(0))) {
      m.acceleration = {};
      return out;
    }
    JointVelocity<N, T> u = wish.velocity;
    bool slowed = false;
    if constexpr (has_contact) {
      const auto verdict = contact_.look(m.contact, measured, u, touch, contact_.distances(nearest), dt);
      out.status |= verdict.status;
      if (verdict.scale < T(1)) slowed = true, u = verdict.scale * u;
    }
    if constexpr (has_watch) {
      const T share = watch_.share(m.watch, u);
      if (share < T(1)) slowed = true, u = share * u;
    }
    const auto room = limits_.room(last.position);
    if constexpr (has_tool) {
      JointVelocity<N, T> reached = u;
      if (slowed) reached = limits_.move(room, last.velocity, u, dt).velocity;
      const auto kept = tool_.within(last.position, room, last.velocity, reached, dt);
      u = kept.velocity;
      if (kept.limited) out.status |= Reason::tool_speed_limited, slowed = true;
    }
    if constexpr (has_clearance) {
      JointVelocity<N, T> reached = u;
      if (slowed) reached = limits_.move(room, last.velocity, u, dt).velocity;
      const auto kept = clearance_.within(
          m.around, last.position, room, last.velocity, reached, dt, [&](const JointVelocity<N, T>& v) {
            if constexpr (has_tool) {
              return tool_.keeps(last.position, v, half_way(last, v, dt), room);
            } else {
              return true;
            }
          });
      u = kept.velocity;
      if (kept.limited) out.status |= Reason::clearance_kept, slowed = true;
    }
    if constexpr (has_jerk) {
      const auto motion = jerk_.move(room, last.velocity, m.acceleration, u, dt);
      // A jerk limit that would make the tool too fast, or bring links too close, gives way.
      Status lost;
      if constexpr (has_tool)
        if (!tool_.keeps(last.position, motion.velocity, motion.displacement, room))
          lost |= Reason::tool_speed_limited;
      if constexpr (has_clearance)
        if (!clearance_.keeps(m.around, last.position, motion.velocity, motion.displacement, room))
          lost |= Reason::clearance_kept;
      if (lost.any()) {
        out.status |= lost | Status(Reason::jerk_exceeded);
        const auto hard = limits_.move(room, last.velocity, u, dt);
        for (std::size_t i = 0; i < N; ++i) m.acceleration[i] = (hard.velocity[i] - last.velocity[i]) / dt;
        make(m, last, hard, dt, out);
        return out;
      }
      out.status |= motion.status;
      m.acceleration = motion.acceleration;
      make(m, last, motion, dt, out);
    } else if (slowed) {
      const auto motion = limits_.move(room, last.velocity, u, dt);
      out.status |= Status::from_bits(motion.status.bits() & ~Status(Reason::acceleration_limited).bits());
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
      out.status |= Status::from_bits(motion.status.bits() & ~Status(Reason::acceleration_limited).bits());
      if constexpr (has_jerk)
        for (std::size_t i = 0; i < N; ++i) m.acceleration[i] = (motion.velocity[i] - last.velocity[i]) / dt;
      make(m, last, motion, dt, out);
    }
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
  /// The displacement from the last command to the velocity `v` after `dt`.
  static SKINCTL_INLINE JointPosition<N, T> half_way(const JointCommand<N, T>& last,
                                                     const JointVelocity<N, T>& v, const T& dt) noexcept {
    return integrate(JointPosition<N, T>(), last.velocity + v, T(T(0.5) * dt));
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

  JointLimits<N, T> limits_;
  [[no_unique_address]] Jerk jerk_;
  [[no_unique_address]] Tool tool_;
  [[no_unique_address]] Contact contact_;
  [[no_unique_address]] Range motion_;
  [[no_unique_address]] Watch watch_;
  [[no_unique_address]] Clear clearance_;
};

/// A governor from its parts, in any order; `limits` are those of resolver and guard.
template <std::size_t N, Real T, class... Parts>
[[nodiscard]] auto make_governor(const JointLimits<N, T>& limits, const Parts&... parts) {
  static_assert(sizeof...(Parts) > 0, "a governor without parts: leave it out of the cycle");
  detail::check_parts<Parts...>();
  return detail::with_parts(
      [&](const auto& jerk, const auto& tool, const auto& contact, const auto& motion, const auto& watch,
          const auto& clearance) {
        using std::remove_cvref_t;
        return Governor<N, T, remove_cvref_t<decltype(jerk)>, remove_cvref_t<decltype(tool)>,
                        remove_cvref_t<decltype(contact)>, remove_cvref_t<decltype(motion)>,
                        remove_cvref_t<decltype(watch)>, remove_cvref_t<decltype(clearance)>>(
            limits, jerk, tool, contact, motion, watch, clearance);
      },
      parts...);
}

SKINCTL_END_NAMESPACE
