// The governor of a robot whose joints have several interfaces.
#pragma once

#include "skinctl/limits/governor.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
/// The limits of a subset of joints.
template <class Set, std::size_t N, Real T>
[[nodiscard]] SKINCTL_COLD JointLimits<Set::count, T> limits_of_part(const JointLimits<N, T>& whole) {
  const auto& v = whole.values();
  return JointLimits<Set::count, T>({Set::of(v.lower), Set::of(v.upper), Set::of(v.velocity),
                                     Set::of(v.acceleration), Set::of(v.torque), Set::of(v.power)});
}
}  // namespace detail

/// A `Governor` for a robot in groups of joints. Contact and tool speed look at one velocity of the whole robot:
/// that of the commands for joints by position or velocity, and for joints by torque the one to which the torque
/// leads in a few cycles. What they leave of it, the former reach as in a `Governor`, within the limits of the
/// joints (and of jerk), and the latter by less torque. Jerk is limited where motion is commanded; of a joint by
/// torque it is the world's as well, and its number in `MaxJerk` is not read.
///
/// Position and speed of joints by torque are limited by `MotionLimits`, as in a `Governor`.
///
/// @tparam Sets  `JointGroups`.
template <class Sets, std::size_t N, Real T, class Jerk, class Tool, class Contact, class Range, class Watch,
          class Clear>
class GroupGovernor : public detail::GovernorParts<N, T, Jerk, Tool, Contact, Range, Watch, Clear> {
  using Parts = detail::GovernorParts<N, T, Jerk, Tool, Contact, Range, Watch, Clear>;
  using Driven = typename Sets::Driven;
  using Groups = typename Sets::StiffGroups;
  static constexpr std::size_t stiff_groups = std::tuple_size_v<Groups>;
  template <std::size_t K>
  using Set = JointSubset<N, std::tuple_element_t<K, Groups>::set>;

 public:
  using Parts::braking_cycles;
  using Parts::has_clearance;
  using Parts::has_jerk;
  using Parts::has_tool;
  static constexpr bool has_driven = Driven::count > 0;

 private:
  template <std::size_t K>
  using Part =
      Governor<Set<K>::count, T, std::conditional_t<has_jerk, JerkLimits<Set<K>::count, T>, detail::NoPart>,
               detail::NoPart, detail::NoPart, detail::NoPart>;
  template <std::size_t K>
  struct MemoryOf {
    typename Part<K>::Memory value;
  };
  template <class Indices>
  struct Each;
  template <std::size_t... K>
  struct Each<std::index_sequence<K...>> {
    using Parts = std::tuple<Part<K>...>;
    struct Memory : MemoryOf<K>... {};
    static Parts make(const JointLimits<N, T>& limits, const Jerk& jerk) {
      return Parts(part<K>(limits, jerk)...);
    }
  };
  template <std::size_t K>
  [[nodiscard]] static Part<K> part(const JointLimits<N, T>& limits, [[maybe_unused]] const Jerk& jerk) {
    const auto own = detail::limits_of_part<Set<K>>(limits);
    if constexpr (has_jerk) {
      return Part<K>(own, JerkLimits<Set<K>::count, T>(own, Set<K>::of(jerk.jerk())), {}, {});
    } else {
      return Part<K>(own, {}, {}, {});
    }
  }
  using All = Each<std::make_index_sequence<stiff_groups>>;

 public:
  /// Trivially copyable.
  struct Memory : Parts::Memory {
    typename All::Memory stiff;
  };

  SKINCTL_COLD GroupGovernor(const JointLimits<N, T>& limits, const Jerk& jerk, const Tool& tool,
                             const Contact& contact, const Range& motion, const Watch& watch,
                             const Clear& clearance)
      : Parts(limits, jerk, tool, contact, motion, watch, clearance), parts_(All::make(limits, jerk)) {}

  /// The command in place of `wish`, as `Governor::step` and `Governor::step_torque`.
  ///
  /// @param hold      the torque that holds the joints by torque.
  /// @param stopping  whether the guard waits for consent: then hold with damping.
  /// @param stale     whether the measured velocities are too old to brake by.
  /// @param rate      fastest change of a torque that the guard allows, see `MotionLimits`.
  /// @param spans     the time to the command of each group by position or velocity [s].
  /// @param dt        seconds since the last cycle.
  /// @param hard      whether jerk gives way, see `Resolver::stops_or_corrects`.
  /// @param stops     whether a stop was requested: it ends at a clearance, and does not slide along.
  template <class Touch, class Nearest>
  SKINCTL_NOINLINE GovernedTorque<N, T> step(Memory& m, const JointCommand<N, T>& last,
                                             const JointCommand<N, T>& wish, const JointTorque<N, T>& hold,
                                             bool stopping, bool stale, const T& rate,
                                             const State<N, T>& measured, const Touch& touch,
                                             const Nearest& nearest, const std::array<T, stiff_groups>& spans,
                                             const T& dt, bool hard = false,
                                             bool stops = false) const noexcept {
    GovernedTorque<N, T> out{{wish, {}, false}, hold};
    if (!last.valid || !wish.valid || !detail::is_plausible(wish) || !detail::is_finite(hold) ||
        !(dt > T(0))) {
      each([&](auto k) { memory<k.value>(m).acceleration = {}; });
      return out;
    }
    T ahead = T(braking_cycles) * dt;
    // A guard turns a torque over its whole range in 20 ms: at high rates braking begins earlier than that.
    if (ahead < T(0.01)) ahead = T(0.01);
    JointVelocity<N, T> u = wish.velocity, from = last.velocity;
    JointPosition<N, T> q = last.position;
    [[maybe_unused]] MassMatrix<N, T> mass;
    if constexpr (has_driven) {
      Driven::put(Driven::of(measured.q), q);
      Driven::put(Driven::of(stale ? JointVelocity<N, T>{} : measured.dq), from);
      Driven::put(Driven::of(from), u);
      if (stale) {
        m.motion.known = false;
      } else {
        const JointAngles<std::remove_cvref_t<decltype(motion_.model())>, T> angles(motion_.model(),
                                                                                    measured.q);
        mass = mass_matrix(motion_.model(), angles);
        const auto bias = bias_torque(motion_.model(), angles, measured.dq);
        const auto acted = Driven::of(last.torque);
        motion_.observe(m.motion, mass, bias, measured, acted, dt);
        const auto kept =
            motion_.within(m.motion, limits_, mass, bias, measured, acted,
                           Driven::of(limits_.within(out.command.torque, measured.dq)), ahead, dt, rate);
        Driven::put(kept.u, u);
        out.status |= kept.status;
        if (kept.altered) {
          Driven::put(kept.torque, out.command.torque);
          out.command.torque = limits_.within(out.command.torque, measured.dq);
          out.altered = true;
        }
      }
    }
    const JointVelocity<N, T> predicted = u;
    detail::Slowed<N, T> left = this->felt(m, measured, u, touch, nearest, dt);
    stopping = stopping || left.status.has(Reason::contact_force) || left.status.has(Reason::contact_power);
    const auto room = limits_.room(q);
    this->keep_tool_speed(q, room, from, dt, left);
    if constexpr (has_clearance &&
                  has_driven) {  // they follow their torques later than the others their commands
      const T share = clearance_.share(m.around, q, left.velocity, ahead);
      if (share < T(1)) left.status |= Reason::clearance_kept;
      left.by(share);
    }
    this->keep_clear(m, q, room, from, dt, left, !stops);
    u = left.velocity;
    out.status |= left.status;
    if constexpr (has_jerk) {
      if (hard) [[unlikely]] {
        if (left.slowed) follow<false>(m, last, u, spans, out);
        each([&](auto k) { memory<k.value>(m).acceleration = {}; });
      } else {
        const Memory before = m;
        const Status given = out.status;
        follow<true>(m, last, u, spans, out);
        // A jerk limit that would make the tool too fast, or bring links too close, gives way.
        JointPosition<N, T> way = this->half_way(from, u, dt);
        JointVelocity<N, T> v = u;
        each([&](auto k) {
          Set<k.value>::put(Set<k.value>::of(out.command.position - last.position), way);
          Set<k.value>::put(Set<k.value>::of(out.command.velocity), v);
        });
        const Status broken = this->broken(m, q, room, v, way);
        if (broken.any()) {
          m.stiff = before.stiff;
          out.status = given | broken;
          follow<false>(m, last, u, spans, out);
        }
      }
      each([&](auto k) {
        using S = Set<k.value>;
        out.status |=
            std::get<k.value>(parts_).exceeded(part_of<S>(last), part_of<S>(out.command), spans[k.value]);
      });
    } else if (left.slowed) {
      follow<false>(m, last, u, spans, out);
    }
    if constexpr (has_driven) {
      if (stale) return out;
      if (left.slowed) {
        brake(mass, predicted - u, ahead, measured.dq, out.command.torque);
        out.altered = true;
      }
      if (stopping) brake(mass, measured.dq, ahead, measured.dq, out.hold);
    }
    return out;
  }

  /// The guard sent `command` instead.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<N, T>& command) const noexcept {
    if constexpr (has_jerk)
      each([&](auto k) { memory<k.value>(m).acceleration = Set<k.value>::of(command.acceleration); });
  }

 private:
  /// The commands of the stiff joints towards the velocities `u`.
  template <bool Smooth>
  SKINCTL_INLINE void follow(Memory& m, const JointCommand<N, T>& last, const JointVelocity<N, T>& u,
                             const std::array<T, stiff_groups>& spans,
                             GovernedTorque<N, T>& out) const noexcept {
    each([&](auto k) {
      using S = Set<k.value>;
      Governed<S::count, T> part{part_of<S>(out.command), {}, false};
      std::get<k.value>(parts_).template follow<Smooth>(memory<k.value>(m), part_of<S>(last), S::of(u),
                                                        spans[k.value], part);
      out.status |= part.status;
      out.altered = true;
      put_part<S>(part.command, out.command);
    });
  }
  /// Takes the velocity `u` of the driven joints from them in `ahead` seconds.
  SKINCTL_INLINE void brake(const MassMatrix<N, T>& mass, const JointVelocity<N, T>& u, const T& ahead,
                            const JointVelocity<N, T>& dq, JointTorque<N, T>& torque) const noexcept {
    const auto p = momentum_of<Driven>(mass, u);
    for (std::size_t i = 0; i < Driven::count; ++i) torque[Driven::index[i]] -= p[i] / ahead;
    torque = limits_.within(torque, dq);
  }
  template <std::size_t K>
  [[nodiscard]] static SKINCTL_INLINE typename Part<K>::Memory& memory(Memory& m) noexcept {
    return static_cast<MemoryOf<K>&>(m.stiff).value;
  }
  template <class F>
  static SKINCTL_INLINE void each(F&& f) noexcept {
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      (f(std::integral_constant<std::size_t, K>{}), ...);
    }(std::make_index_sequence<stiff_groups>{});
  }

  using Parts::clearance_;
  using Parts::limits_;
  using Parts::motion_;
  typename All::Parts parts_;
};

/// As `make_governor`, for a robot in groups; for joints by torque `parts` hold their `MotionLimits`.
template <class Sets, std::size_t N, Real T, class... Parts>
[[nodiscard]] auto make_group_governor(const JointLimits<N, T>& limits, const Parts&... parts) {
  detail::check_parts<Parts...>();
  return detail::with_parts(
      [&]<class... P>(const P&... given) { return GroupGovernor<Sets, N, T, P...>(limits, given...); },
      parts...);
}

SKINCTL_END_NAMESPACE
