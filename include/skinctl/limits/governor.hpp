// Keeps the limits that concern the whole robot: slows commands down between resolver and guard.
#pragma once

#include <tuple>

#include "skinctl/core/detail/plain_tuple.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/limits/detail/drive.hpp"
#include "skinctl/limits/detail/group_motion.hpp"
#include "skinctl/limits/detail/limit_list.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A command that a governor passed or slowed; `altered` is true if it was slowed.
template <std::size_t N, Real T>
struct Governed {
  JointCommand<N, T> command;
  Status status;
  bool altered = false;
};
/// The same with joints by torque; `hold` is the torque that holds them if the guard refuses the command.
template <std::size_t N, Real T>
struct GovernedTorque : Governed<N, T> {
  JointTorque<N, T> hold;
};

/// What a governor reads beside the command.
/// @tparam Groups  number of groups of joints by position or velocity.
template <std::size_t N, Real T, std::size_t Groups>
struct GovernorInput {
  const JointCommand<N, T>& last;  ///< the command that left last
  const State<N, T>& measured;     ///< the last good state of the robot
  std::array<T, Groups> spans;     ///< time in which the command of each group is to be reached [s]
  T dt;                            ///< time since the last cycle [s]
  T torque_rate = T(0);            ///< fastest change of a torque that the guard allows [limits per second]
  bool stale = false;  ///< whether measured velocities are too old to brake by: then joints by torque pass
  bool waits = false;  ///< whether joints by torque are to be held with damping
  bool hard = false;   ///< whether a smooth motion gives way, see `Resolver::stops_or_corrects`
  bool stops = false;  ///< whether a stop was requested: it ends at a limit, and does not slide along
};

/// The stage between resolver and guard of a scene: its limits in the order of their precedence. It knows what a limit
/// is (`limits/limit.hpp`), and names none.
///
/// **Joints by position and velocity.** A command within the limits passes to the bit. Otherwise all joints are slowed
/// alike or turned aside as the limits say, a motion from the last command to that velocity is computed within the
/// limits of the joints (or as the limit says that decides how joints move), and the resolver learns what was sent: its
/// virtual robot goes on from there, so nothing is caught up later. Where one limit decides how joints move, every
/// command is computed anew, except while the robot stops or is held: then the resolver's own braking passes.
///
/// Where limits conflict, the joints' acceleration, position and velocity hold; then the later in the order wins. A
/// smooth motion that would break another limit gives way.
///
/// **Joints by torque.** The motion under external forces is unknown, so the speed is braked: `braking_cycles` cycles
/// ahead, after T, the torque leads to `u = dq + T M^-1 (tau - hold)`, of which the limits leave u'. `tau - M (u - u') / T`
/// leads to u': drive that would make the robot too fast, or press harder than a region allows, is removed, and a robot
/// that is pushed too fast is damped; what pushes it (the `resistance` of `MotionLimits`) counts as well, but not for a
/// contact, whose force it would hide. It sets in without a jump (u' = u leaves the torque to the bit), and never exceeds
/// the joints' torques.
///
/// @tparam Sets    `JointGroups` of the robot.
/// @tparam Limits  in the order of their precedence.
template <RobotModel M, Real T, class Sets, class... Limits>
class Governor {
 public:
  static constexpr std::size_t joints = M::joints;
  using scalar = T;
  static constexpr std::size_t count = sizeof...(Limits);
  /// Whether it has any limit: without, the stage costs nothing.
  static constexpr bool acts = count > 0;
  static constexpr std::size_t groups = std::tuple_size_v<typename Sets::StiffGroups>;
  static constexpr bool has_driven = Sets::Driven::count > 0, has_motion = groups > 0;
  /// Whether one of the limits decides how joints move.
  static constexpr bool smooth = (detail::DecidesMotion<Limits> || ...);
  /// Whether one of them asks for contacts, and for the skin's coverage.
  static constexpr bool reads_touch = (detail::ReadsTouch<Limits> || ...);
  static constexpr bool reads_coverage = (detail::ReadsCoverage<Limits> || ...);
  static constexpr bool may_stay = (detail::Stays<Limits> || ...);
  /// The links whose touch they read.
  static constexpr LinkMask links = [] {
    LinkMask all = 0;
    (
        [&] {
          if constexpr (detail::ReadsTouch<Limits>) all |= Limits::links;
        }(),
        ...);
    return all;
  }();
  /// The number of cycles of the prediction of torques, and of braking by them.
  static constexpr int braking_cycles = 4;
  using Input = GovernorInput<joints, T, groups>;
  using Output = std::conditional_t<has_driven, GovernedTorque<joints, T>, Governed<joints, T>>;

 private:
  using Driven = typename Sets::Driven;
  using Position = JointPosition<joints, T>;
  using Velocity = JointVelocity<joints, T>;
  using Going = skinctl::Going<joints, T, has_motion, has_driven>;
  using Command = JointCommand<joints, T>;
  template <std::size_t K>
  using Limit = std::tuple_element_t<K, std::tuple<Limits...>>;
  template <std::size_t K>
  using Set = JointSubset<joints, std::tuple_element_t<K, typename Sets::StiffGroups>::set>;
  static constexpr std::size_t mover_place = detail::place_of<count>({detail::DecidesMotion<Limits>...});
  static constexpr std::size_t of_torque = detail::place_of<count>({detail::LimitsTorque<Limits>...});

  template <class Indices>
  struct Each;
  template <std::size_t... K>
  struct Each<std::index_sequence<K...>> {
    template <std::size_t G>
    using Mover = decltype(detail::mover_among<mover_place>(std::declval<const std::tuple<Limits...>&>())
                               .template set<Set<G>>());
    using Motions = std::tuple<detail::GroupMotion<Set<K>::count, T, Mover<K>>...>;
    using Memory = detail::PlainTuple<detail::GroupMotionMemory<Set<K>::count, T>...>;
    static Motions make(const JointLimits<joints, T>& limits, const std::tuple<Limits...>& all) {
      return Motions(detail::GroupMotion<Set<K>::count, T, Mover<K>>(
          limits.template part<Set<K>>(), detail::mover_among<mover_place>(all).template set<Set<K>>())...);
    }
  };
  using OfGroups = Each<std::make_index_sequence<groups>>;

 public:
  /// Trivially copyable.
  struct Memory {
    [[no_unique_address]] detail::PlainTuple<typename Limits::Memory...> limits;
    [[no_unique_address]] typename OfGroups::Memory groups;
  };

  SKINCTL_COLD Governor(const M& model, const JointLimits<joints, T>& limits, const Limits&... parts)
      : model_(model), limits_(limits), parts_(parts...), motions_(OfGroups::make(limits, parts_)) {}

  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return limits_; }
  /// Whether it has a limit of this kind, named by its `Kind` or by its settings.
  template <class Kind>
  static constexpr bool has = (detail::of_kind<Limits, Kind> || ...);
  /// The limit of a kind, and its memory.
  template <class Kind>
    requires(has<Kind>)
  [[nodiscard]] const auto& get() const noexcept {
    return std::get<place<Kind>>(parts_);
  }
  template <class Kind>
    requires(has<Kind>)
  [[nodiscard]] static const auto& memory(const Memory& m) noexcept {
    return detail::element<place<Kind>>(m.limits);
  }

  /// The limit that decides how joints move.
  [[nodiscard]] const auto& mover() const noexcept
    requires smooth
  {
    return std::get<mover_place>(parts_);
  }

  /// Takes what the limits ask from the input of a cycle at `now`; the robot was measured at `q`.
  template <class In>
  SKINCTL_INLINE void see(Memory& m, const In& input, const Position& q, Nanoseconds now) const noexcept {
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (detail::LimitWithInput<Limit<K>>) part<K>().see(own<K>(m), input, q, now);
    });
  }
  /// Looks at the skin, `dt` seconds after the last cycle.
  template <class Seen>
  SKINCTL_INLINE Status look(Memory& m, const Seen& seen, const T& dt) const noexcept {
    Status status;
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (detail::Looks<Limit<K>, Seen, T>) status |= part<K>().look(own<K>(m), seen, dt);
    });
    return status;
  }
  /// Throws `ConfigurationError` for a robot that a limit does not suit.
  template <class Robot>
  SKINCTL_COLD void check(const Robot& robot) const {
    const auto one = [&](const auto& limit) {
      if constexpr (detail::ChecksRobot<std::remove_cvref_t<decltype(limit)>, Robot>) limit.check(robot);
    };
    std::apply([&](const auto&... limit) { (one(limit), ...); }, parts_);
  }
  /// Whether the robot is to brake and hold by one of them.
  [[nodiscard]] SKINCTL_INLINE bool stays(const Memory& m) const noexcept {
    bool any = false;
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (detail::Stays<Limit<K>>) any = any || part<K>().stays(own<K>(m));
    });
    return any;
  }
  /// The robot stands off its commands: measured less expected positions.
  SKINCTL_INLINE void stand_off(Memory& m, const Position& off) const noexcept {
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (detail::StandsOff<Limit<K>>) part<K>().stand_off(own<K>(m), off);
    });
  }
  static constexpr bool stands_off = (detail::StandsOff<Limits> || ...);

  /// The command in place of `wish`.
  ///
  /// @param hold  the torque that holds the joints by torque: gravity compensation, with friction if it has some.
  /// @param seen  the touch of this cycle: `pressed()` (`PressedAreas`, or wrenches on the links), `nearest<I>()` (the
  ///              strongest proximity reading of a link) and `coverage()`, as far as limits ask.
  /// A `wish` that is not valid, not finite, or far from any robot passes: the guard refuses it.
  template <class Seen>
  SKINCTL_INLINE Output step(Memory& m, const Input& in, const Command& wish,
                             const JointTorque<joints, T>& hold, const Seen& seen) const noexcept {
    Output out = passed(wish, hold);
    if (!usable(in, wish, hold)) {
      forget(m);
      return out;
    }
    if constexpr (has_driven) {
      with_driven(m, in, seen, out);
    } else {
      const Going going = going_of(in);
      detail::Slowed<joints, T> left{wish.velocity, {}};
      each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA { act<K>(m, going, seen, left); });
      out.status |= left.status;
      move(m, in, going, left, out);
    }
    return out;
  }

  /// The guard sent `command` instead.
  SKINCTL_INLINE void sent(Memory& m, const Command& command) const noexcept {
    if constexpr (smooth)
      each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
        detail::element<K>(m.groups).acceleration = Set<K>::of(command.acceleration);
      });
  }

 private:
  template <class Kind>
  static constexpr std::size_t place = detail::place_of<count>({detail::of_kind<Limits, Kind>...});
  template <std::size_t K>
  [[nodiscard]] SKINCTL_INLINE const Limit<K>& part() const noexcept {
    return std::get<K>(parts_);
  }
  template <std::size_t K>
  [[nodiscard]] static SKINCTL_INLINE auto& own(Memory& m) noexcept {
    return detail::element<K>(m.limits);
  }
  template <std::size_t K>
  [[nodiscard]] static SKINCTL_INLINE const auto& own(const Memory& m) noexcept {
    return detail::element<K>(m.limits);
  }
  template <class F>
  static SKINCTL_INLINE void each_limit(F&& f) noexcept {
    [&]<std::size_t... K>(std::index_sequence<K...>)
        SKINCTL_INLINE_LAMBDA { (f.template operator()<K>(), ...); }(std::index_sequence_for<Limits...>{});
  }
  template <class F>
  static SKINCTL_INLINE void each_group(F&& f) noexcept {
    [&]<std::size_t... K>(std::index_sequence<K...>)
        SKINCTL_INLINE_LAMBDA { (f.template operator()<K>(), ...); }(std::make_index_sequence<groups>{});
  }

  [[nodiscard]] static SKINCTL_INLINE Output passed(const Command& wish,
                                                    const JointTorque<joints, T>& hold) noexcept {
    if constexpr (has_driven) {
      return {{wish.copy(), {}, false}, hold};
    } else {
      return {wish.copy(), {}, false};
    }
  }
  [[nodiscard]] static SKINCTL_INLINE bool usable(const Input& in, const Command& wish,
                                                  const JointTorque<joints, T>& hold) noexcept {
    const bool good = wish.valid && detail::is_plausible(wish) && in.dt > T(0);
    return good && (!has_motion || in.last.valid) && (!has_driven || detail::is_finite(hold));
  }
  SKINCTL_INLINE void forget(Memory& m) const noexcept {
    each_group([&]<std::size_t K>()
                   SKINCTL_INLINE_LAMBDA { detail::element<K>(m.groups).acceleration = {}; });
    if constexpr (of_torque < count) own<of_torque>(m).known = false;
  }
  [[nodiscard]] SKINCTL_INLINE Going going_of(const Input& in) const noexcept {
    T dt = has_motion ? in.spans[0] : in.dt;
    if constexpr (has_motion)
      for (const T& span : in.spans) dt = span > dt ? span : dt;
    T ahead(0);
    Position q = in.last.position;
    Velocity from = in.last.velocity;
    if constexpr (has_driven) {
      // A guard turns a torque over its whole range in 20 ms: at high rates braking begins earlier than that.
      ahead = T(braking_cycles) * in.dt;
      if (ahead < T(0.01)) ahead = T(0.01);
      Driven::put(Driven::of(in.measured.q), q);
      Driven::put(Driven::of(in.stale ? Velocity{} : in.measured.dq), from);
    }
    return {q, from, limits_.room(q), in.measured, dt, ahead, !in.stops};
  }
  /// The velocity in the time of the motion: what was asked for is within the limits of the joints, what is slowed may
  /// not be.
  [[nodiscard]] SKINCTL_INLINE Velocity reached(const Going& going,
                                                const detail::Slowed<joints, T>& s) const noexcept {
    return has_motion && s.slowed ? limits_.move(going.room, going.from, s.velocity, going.dt).velocity
                                  : s.velocity;
  }
  /// What the limit `K` leaves.
  template <std::size_t K, class Seen>
  SKINCTL_INLINE void act(Memory& m, const Going& going, const Seen& seen,
                          detail::Slowed<joints, T>& left) const noexcept {
    if constexpr (detail::Shares<Limit<K>, Going, Seen, Velocity>) {
      const auto given = part<K>().share(own<K>(m), going, seen, left.velocity);
      left.status |= given.status;
      left.by(given.scale);
    } else if constexpr (detail::Turns<Limit<K>, Going, Velocity>) {
      const auto earlier = [&](const Velocity& v) { return keeps<K>(m, going, v, going.half_way(v)); };
      const auto kept = part<K>().within(own<K>(m), going, reached(going, left), earlier);
      left.velocity = kept.velocity;
      if (kept.limited) left.status |= Limit<K>::reason, left.slowed = true;
    }
  }
  /// Whether a motion that ends at `v`, by `moved`, keeps the limits before `K`.
  template <std::size_t K>
  [[nodiscard]] SKINCTL_INLINE bool keeps(const Memory& m, const Going& going, const Velocity& v,
                                          const Position& moved) const noexcept {
    bool all = true;
    each_limit([&]<std::size_t J>() SKINCTL_INLINE_LAMBDA {
      if constexpr (J < K && detail::Keeps<Limit<J>, Going, Velocity, Position>)
        all = all && part<J>().keeps(own<J>(m), going, v, moved);
    });
    return all;
  }
  /// The reasons of the limits that such a motion breaks.
  [[nodiscard]] SKINCTL_INLINE Status broken(const Memory& m, const Going& going, const Velocity& v,
                                             const Position& moved) const noexcept {
    Status out;
    each_limit([&]<std::size_t J>() SKINCTL_INLINE_LAMBDA {
      if constexpr (detail::Keeps<Limit<J>, Going, Velocity, Position>)
        if (!part<J>().keeps(own<J>(m), going, v, moved)) out |= Limit<J>::reason;
    });
    return out;
  }

  /// The command of the joints by position and velocity.
  SKINCTL_INLINE void move(Memory& m, const Input& in, const Going& going,
                           const detail::Slowed<joints, T>& left, Output& out) const noexcept {
    if constexpr (smooth) {
      if (in.hard) [[unlikely]] {
        // It is smooth again from no acceleration on: that of hard braking would lead beyond rest.
        if (left.slowed) move_hard(m, in, left.velocity, out);
        each_group([&]<std::size_t K>()
                       SKINCTL_INLINE_LAMBDA { detail::element<K>(m.groups).acceleration = {}; });
      } else {
        move_smoothly(m, in, going, left.velocity, out);
      }
      each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
        out.status |= std::get<K>(motions_).exceeded(part_of<Set<K>>(in.last), part_of<Set<K>>(out.command),
                                                     in.spans[K]);
      });
    } else if (left.slowed) {
      move_hard(m, in, left.velocity, out);
    }
  }
  SKINCTL_INLINE void move_hard(Memory& m, const Input& in, const Velocity& u, Output& out) const noexcept {
    each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      auto command = part_of<Set<K>>(out.command);
      out.status |= std::get<K>(motions_).move(detail::element<K>(m.groups), part_of<Set<K>>(in.last),
                                               Set<K>::of(u), in.spans[K], command);
      put_part<Set<K>>(command, out.command);
    });
    out.altered = true;
  }
  SKINCTL_INLINE void move_smoothly(Memory& m, const Input& in, const Going& going, const Velocity& u,
                                    Output& out) const noexcept {
    [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      const std::tuple motions(std::get<K>(motions_).smoothed(
          detail::element<K>(m.groups), part_of<Set<K>>(in.last), Set<K>::of(u), in.spans[K])...);
      Position moved = going.half_way(u);
      Velocity v = u;
      (Set<K>::put(std::get<K>(motions).displacement, moved), ...);
      (Set<K>::put(std::get<K>(motions).velocity, v), ...);
      if (const Status breaks = broken(m, going, v, moved); breaks.any()) {
        out.status |= breaks;
        move_hard(m, in, u, out);
        return;
      }
      const auto follow = [&]<std::size_t G>() SKINCTL_INLINE_LAMBDA {
        auto command = part_of<Set<G>>(out.command);
        std::get<G>(motions_).follow(detail::element<G>(m.groups), part_of<Set<G>>(in.last),
                                     std::get<G>(motions), command);
        put_part<Set<G>>(command, out.command);
        out.status |= std::get<G>(motions).status;
      };
      (follow.template operator()<K>(), ...);
      out.altered = true;
    }(std::make_index_sequence<groups>{});
  }

  /// The same with joints by torque.
  template <class Seen>
  SKINCTL_NOINLINE void with_driven(Memory& m, const Input& in, const Seen& seen,
                                    Output& out) const noexcept {
    const Going going = going_of(in);
    detail::Slowed<joints, T> left{out.command.velocity, {}};
    if (in.stale) {
      if constexpr (of_torque < count) own<of_torque>(m).known = false;
      if constexpr (has_motion) {
        Driven::put(Driven::of(going.from), left.velocity);
        each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA { act<K>(m, going, seen, left); });
        out.status |= left.status;
        move(m, in, going, left, out);
      }
      return;
    }
    const detail::Drive<Driven, M, T> drive(model_, limits_, in.measured, out.command.torque, going.ahead);
    const auto acted = Driven::of(in.last.torque);
    auto braked = drive.asked;
    if constexpr (of_torque < count)
      part<of_torque>().observe(own<of_torque>(m), drive.mass, drive.bias, in.measured, acted, in.dt);
    bool waits = in.waits;
    if constexpr (judges_velocity) {
      JointVelocity<Driven::count, T> led, world;
      JointTorque<Driven::count, T> resistance;
      if constexpr (of_torque < count) resistance = part<of_torque>().resistance(own<of_torque>(m));
      if (!drive.leads(out.hold, resistance, led, world)) return;
      Velocity u = left.velocity;
      Driven::put(led, u);
      Driven::put(counted(in, going, led), left.velocity);
      each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
        if constexpr (detail::OfTheDrive<Limit<K>>) act<K>(m, going, seen, left);
      });
      Driven::put(Driven::of(u) + world, u);
      Driven::put(counted(in, going, Driven::of(left.velocity) + world), left.velocity);
      each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
        if constexpr (!detail::OfTheDrive<Limit<K>>) act<K>(m, going, seen, left);
      });
      out.status |= left.status;
      waits = waits || (left.status & holds_on).any();
      if (left.slowed) {
        braked = drive.asked - drive.that_takes(u - left.velocity);
        out.altered = true;
      }
    }
    if constexpr (has_motion) move(m, in, going, left, out);
    if constexpr (of_torque < count) {
      const auto kept =
          part<of_torque>().within(own<of_torque>(m), limits_, drive.mass, drive.bias, in.measured, acted,
                                   braked, going.ahead, in.dt, in.torque_rate);
      out.status |= kept.status;
      if (kept.altered) braked = kept.torque, out.altered = true;
    }
    if (out.altered) out.command.torque = drive.with(out.command.torque, braked);
    if (waits) out.hold = drive.with(out.hold, Driven::of(out.hold) - drive.that_takes(in.measured.dq));
  }
  /// The velocity `u` with which joints by torque count. Beside joints that are commanded to move, and that all slow
  /// alike, it is what the joints' own limits will leave of it: a finger that is pressed against its end slows no arm.
  [[nodiscard]] SKINCTL_INLINE JointVelocity<Driven::count, T> counted(
      const Input& in, const Going& going, JointVelocity<Driven::count, T> u) const noexcept {
    if constexpr (has_motion && of_torque < count) {
      const auto box = part<of_torque>().box(limits_, in.measured, going.ahead);
      for (std::size_t i = 0; i < Driven::count; ++i) u[i] = detail::clamp(u[i], box.lower[i], box.upper[i]);
    }
    return u;
  }
  /// Whether a limit judges velocities.
  static constexpr bool judges_velocity = (!detail::LimitsTorque<Limits> || ...);
  static constexpr Status holds_on = [] {
    Status all;
    (
        [&] {
          if constexpr (detail::HoldsOn<Limits>) all |= Limits::holds_on;
        }(),
        ...);
    return all;
  }();

  [[no_unique_address]] M model_;
  JointLimits<joints, T> limits_;
  [[no_unique_address]] std::tuple<Limits...> parts_;
  [[no_unique_address]] typename OfGroups::Motions motions_;
};

/// The governor of a robot from its limits, in any order.
template <class Sets, RobotModel M, std::size_t N, Real T, class... Limits>
[[nodiscard]] auto make_governor(const M& model, const JointLimits<N, T>& limits, const Limits&... given) {
  const std::tuple<const Limits&...> all(given...);
  constexpr auto order = detail::in_order<Limits...>();
  return [&]<std::size_t... K>(std::index_sequence<K...>) {
    return Governor<M, T, Sets, std::remove_cvref_t<decltype(std::get<order[K]>(all))>...>(
        model, limits, std::get<order[K]>(all)...);
  }(std::index_sequence_for<Limits...>{});
}

SKINCTL_END_NAMESPACE
