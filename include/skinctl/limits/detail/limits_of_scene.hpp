// SPDX-License-Identifier: BSD-3-Clause
// The limits of a scene in the order of their precedence, and what they leave of a velocity.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/core/command.hpp"
#include "skinctl/core/detail/plain_tuple.hpp"
#include "skinctl/limits/detail/limit_list.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The input of a governor beside the command.
template <std::size_t N, Real T>
struct GovernorInput {
  const JointCommand<N, T>& last;  ///< the command that left last
  const State<N, T>& measured;     ///< the last good state of the robot
  T span;                          ///< time in which the robot carries the command out [s]
  T dt;                            ///< time since the last cycle [s]
  T torque_rate = T(0);            ///< fastest change of a torque that the guard allows [limits per second]
  T delay = T(0);                  ///< delay and lag of the joints by torque [s]
  JointTorque<N, T> motors = {};   ///< inertia of the motors at joints by torque [kg m^2]
  bool stale = false;  ///< whether measured velocities are too old to brake by: then joints by torque pass
  bool stops = false;  ///< whether a stop was requested: it ends at a limit, and does not slide along
};

namespace detail {

/// The limits of a `Governor`, which derives from it.
template <RobotModel M, Real T, class Sets, class... Limits>
class LimitsOfScene {
 public:
  static constexpr std::size_t joints = M::joints;
  using scalar = T;
  static constexpr std::size_t count = sizeof...(Limits);
  /// Whether it has any limit: without, the stage costs nothing.
  static constexpr bool acts = count > 0;
  static constexpr std::size_t groups = std::tuple_size_v<typename Sets::StiffGroups>;
  static constexpr bool has_driven = Sets::Driven::count > 0, has_motion = groups > 0;
  /// The number of limits that decide how joints move, and whether there is one.
  static constexpr int movers = (0 + ... + int(DecidesMotion<Limits>));
  static constexpr bool smooth = movers > 0;
  /// Whether a limit asks for contacts, and whether one asks for the skin's coverage.
  static constexpr bool reads_touch = (ReadsTouch<Limits> || ...);
  static constexpr bool reads_coverage = (ReadsCoverage<Limits> || ...);
  static constexpr bool may_stay = (Stays<Limits> || ...);
  /// The links whose touch the limits read.
  static constexpr LinkMask links = [] {
    LinkMask all = 0;
    (
        [&] {
          if constexpr (ReadsTouch<Limits>) all |= Limits::links;
        }(),
        ...);
    return all;
  }();
  /// The time of the prediction of torques, and of braking by them, in cycles and in delays of the joints: at
  /// least twice the loop's delay, faster braking swings.
  static constexpr int braking_cycles = 4, braking_delays = 2;
  /// The shortest time of that prediction [s]: a guard turns a torque over its whole range in 20 ms.
  static constexpr double shortest_braking = 0.01;
  using Input = GovernorInput<joints, T>;

 protected:
  using Driven = typename Sets::Driven;
  using Position = JointPosition<joints, T>;
  using Velocity = JointVelocity<joints, T>;
  using Going = skinctl::Going<joints, T, has_motion, has_driven>;
  using Command = JointCommand<joints, T>;
  template <std::size_t K>
  using Limit = std::tuple_element_t<K, std::tuple<Limits...>>;
  template <std::size_t K>
  using Set = JointSubset<joints, std::tuple_element_t<K, typename Sets::StiffGroups>::set>;
  static constexpr std::size_t mover_place = place_of<count>({DecidesMotion<Limits>...});
  static constexpr std::size_t of_torque = place_of<count>({LimitsTorque<Limits>...});

  template <class Indices>
  struct Each;
  template <std::size_t... K>
  struct Each<std::index_sequence<K...>> {
    template <std::size_t G>
    using Mover = decltype(mover_among<mover_place>(std::declval<const std::tuple<Limits...>&>())
                               .template set<Set<G>>());
    using Motions = std::tuple<GroupMotion<Set<K>::count, T, Mover<K>>...>;
    using Memory = PlainTuple<GroupMotionMemory<Set<K>::count, T>...>;
    static Motions make(const JointLimits<joints, T>& limits, const std::tuple<Limits...>& all) {
      return Motions(GroupMotion<Set<K>::count, T, Mover<K>>(
          limits.template part<Set<K>>(), mover_among<mover_place>(all).template set<Set<K>>())...);
    }
  };
  using OfGroups = Each<std::make_index_sequence<groups>>;

 public:
  /// Trivially copyable.
  struct Memory {
    [[no_unique_address]] PlainTuple<typename Limits::Memory...> limits;
    [[no_unique_address]] typename OfGroups::Memory groups;
  };

  SKINCTL_COLD LimitsOfScene(const M& model, const JointLimits<joints, T>& limits, const Limits&... parts)
      : model_(model), limits_(limits), parts_(parts...), motions_(OfGroups::make(limits, parts_)) {}

  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return limits_; }
  /// Whether the scene has a limit of this kind, named by its `Kind` or by its settings.
  template <class Kind>
  static constexpr bool has = (of_kind<Limits, Kind> || ...);
  /// The limit of a kind; `memory` gives its memory.
  template <class Kind>
    requires(has<Kind>)
  [[nodiscard]] const auto& get() const noexcept {
    return std::get<place<Kind>>(parts_);
  }
  template <class Kind>
    requires(has<Kind>)
  [[nodiscard]] static const auto& memory(const Memory& m) noexcept {
    return element<place<Kind>>(m.limits);
  }

  /// The mover of the group `K`, which decides how its joints move: `Abrupt`, or limits of jerk.
  template <std::size_t K>
  [[nodiscard]] SKINCTL_INLINE const auto& motion_limit_of() const noexcept {
    return std::get<K>(motions_).mover();
  }
  /// The limit that decides how joints move.
  [[nodiscard]] const auto& mover() const noexcept
    requires smooth
  {
    return std::get<mover_place>(parts_);
  }

  /// Gives the limits what they need of the input of a cycle at `now`; the robot was measured at `q`.
  template <class In>
  SKINCTL_INLINE void see(Memory& m, const In& input, const Position& q, Nanoseconds now) const noexcept {
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (LimitWithInput<Limit<K>>) part<K>().see(own<K>(m), input, q, now);
    });
  }
  /// Lets the limits look at the skin, `dt` seconds after the last cycle.
  template <class Seen>
  SKINCTL_INLINE Status look(Memory& m, const Seen& seen, const T& dt) const noexcept {
    Status status;
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (Looks<Limit<K>, Seen, T>) status |= part<K>().look(own<K>(m), seen, dt);
    });
    return status;
  }
  /// Throws `ConfigurationError` for a robot that a limit does not suit.
  template <class Robot>
  SKINCTL_COLD void check(const Robot& robot) const {
    const auto one = [&](const auto& limit) {
      if constexpr (ChecksRobot<std::remove_cvref_t<decltype(limit)>, Robot>) limit.check(robot);
    };
    std::apply([&](const auto&... limit) { (one(limit), ...); }, parts_);
  }
  /// Whether the robot is to brake and hold because of a limit.
  [[nodiscard]] SKINCTL_INLINE bool stays(const Memory& m) const noexcept {
    bool any = false;
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (Stays<Limit<K>>) any = any || part<K>().stays(own<K>(m));
    });
    return any;
  }
  /// Tells the limits the robot's deviation from its commands: measured less expected positions [rad].
  SKINCTL_INLINE void stand_off(Memory& m, const Position& off) const noexcept {
    each_limit([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (StandsOff<Limit<K>, Position>) part<K>().stand_off(own<K>(m), off);
    });
  }
  static constexpr bool stands_off = (StandsOff<Limits, Position> || ...);

 protected:
  template <class Kind>
  static constexpr std::size_t place = place_of<count>({of_kind<Limits, Kind>...});
  template <std::size_t K>
  [[nodiscard]] SKINCTL_INLINE const Limit<K>& part() const noexcept {
    return std::get<K>(parts_);
  }
  template <std::size_t K>
  [[nodiscard]] static SKINCTL_INLINE auto& own(Memory& m) noexcept {
    return element<K>(m.limits);
  }
  template <std::size_t K>
  [[nodiscard]] static SKINCTL_INLINE const auto& own(const Memory& m) noexcept {
    return element<K>(m.limits);
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

  [[nodiscard]] SKINCTL_INLINE Going going_of(const Input& in) const noexcept {
    const T dt = has_motion ? in.span : in.dt;
    T ahead(0);
    Position q = in.last.position;
    Velocity from = in.last.velocity;
    if constexpr (has_driven) {
      ahead = T(braking_cycles) * in.dt + T(braking_delays) * in.delay;
      if (ahead < T(shortest_braking)) ahead = T(shortest_braking);
      Driven::put(Driven::of(in.measured.q), q);
      Driven::put(Driven::of(in.stale ? Velocity{} : in.measured.dq), from);
    }
    return {q, from, limits_.room(q), in.measured, dt, in.dt, ahead, !in.stops};
  }
  SKINCTL_INLINE static void forget_torque(Memory& m) noexcept {
    if constexpr (of_torque < count) Limit<of_torque>::forget(own<of_torque>(m));
  }
  /// The velocity that joints reach in the time of the motion: one that was asked for is within their limits,
  /// a slowed one may not be.
  [[nodiscard]] SKINCTL_INLINE Velocity reached(const Going& going,
                                                const Slowed<joints, T>& s) const noexcept {
    return has_motion && s.slowed ? limits_.move(going.room, going.from, s.velocity, going.dt).velocity
                                  : s.velocity;
  }
  /// Applies the limit `K` to the velocity in `left`.
  template <std::size_t K, class Seen>
  SKINCTL_INLINE void act(Memory& m, const Going& going, const Seen& seen,
                          Slowed<joints, T>& left) const noexcept {
    if constexpr (Shares<Limit<K>, Going, Seen, Velocity>) {
      const auto given = part<K>().share(own<K>(m), going, seen, left.velocity);
      left.status |= given.status;
      left.by(given.scale);
    } else if constexpr (Turns<Limit<K>, Going, Velocity>) {
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
      if constexpr (J < K && Keeps<Limit<J>, Going, Velocity, Position>)
        all = all && part<J>().keeps(own<J>(m), going, v, moved);
    });
    return all;
  }
  /// The reasons of the limits that a motion breaks which ends at `v`, by `moved`.
  [[nodiscard]] SKINCTL_INLINE Status broken(const Memory& m, const Going& going, const Velocity& v,
                                             const Position& moved) const noexcept {
    Status out;
    each_limit([&]<std::size_t J>() SKINCTL_INLINE_LAMBDA {
      if constexpr (Keeps<Limit<J>, Going, Velocity, Position>)
        if (!part<J>().keeps(own<J>(m), going, v, moved)) out |= Limit<J>::reason;
    });
    return out;
  }
  /// The reasons of the limits that the mean velocity of joints by position breaks, where that is not midway
  /// between start and end: a motion in several substeps, or within a limit of jerk, may be faster between.
  /// What is sent to joints by velocity is the speed at the end.
  [[nodiscard]] SKINCTL_INLINE Status broken_between(const Memory& m, const Going& going, const Velocity& v,
                                                     const Position& moved) const noexcept {
    bool bulges = false;
    Velocity mean = v;
    const Position straight = going.half_way(v);
    each_group([&]<std::size_t K>() SKINCTL_INLINE_LAMBDA {
      if constexpr (takes_position(std::tuple_element_t<K, typename Sets::StiffGroups>::interface))
        for (const std::size_t i : Set<K>::index) {
          bulges = bulges || magnitude(T(moved[i] - straight[i])) > rounding_of_positions;
          mean[i] = moved[i] / going.dt;
        }
    });
    return bulges ? broken(m, going, mean, moved) : Status();
  }
  /// Difference of positions that is their rounding [rad].
  static constexpr T rounding_of_positions = T(256) * std::numeric_limits<T>::epsilon();

  /// Whether a limit judges velocities.
  static constexpr bool judges_velocity = (!LimitsTorque<Limits> || ...);
  [[no_unique_address]] M model_;
  JointLimits<joints, T> limits_;
  [[no_unique_address]] std::tuple<Limits...> parts_;
  [[no_unique_address]] typename OfGroups::Motions motions_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
