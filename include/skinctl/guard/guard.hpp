// SPDX-License-Identifier: BSD-3-Clause
// The guard: the last stage before a command leaves.
#pragma once

#include <tuple>

#include "skinctl/core/detail/plain_tuple.hpp"
#include "skinctl/guard/joint_guard.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The guard of a robot: a `JointGuard` for each group of joints by position or velocity of its `Resolver`,
/// and one for the joints by torque. Each reacts to faults of its own joints and to those that other stages
/// found; a fault of one that waits for consent stops all, by the resolver, until `acknowledge`. Limits and
/// periods are the resolver's; the settings are those of the whole robot.
///
/// @tparam Mover  `Abrupt`, or a limit that decides how joints move: then they brake as it says.
template <class Robot, class Mover = Abrupt>
class Guard {
 public:
  static constexpr std::size_t joints = Robot::joints;
  using scalar = typename Robot::scalar;
  static constexpr bool smooth = !std::is_same_v<Mover, Abrupt> && Robot::has_virtual;
  using Driven = typename Robot::Driven;
  using T = scalar;
  using Settings = GuardSettings<joints, T>;
  using Command = JointCommand<joints, T>;

 private:
  template <std::size_t K>
  using Set = typename Robot::template Part<K>;
  template <std::size_t K>
  using Braking = decltype(std::declval<const Mover&>().template set<Set<K>>());
  template <std::size_t K>
  using Stiff = JointGuard<Robot::template Group<K>::interface, Set<K>::count, T, Braking<K>>;
  template <class Indices>
  struct Each;
  template <std::size_t... K>
  struct Each<std::index_sequence<K...>> {
    using Guards = std::tuple<Stiff<K>...>;
    using Memory = detail::PlainTuple<GuardMemory<Set<K>::count, T>...>;
    static Guards make(const Robot& r, const Settings& s, const Mover& mover) {
      return Guards(Stiff<K>(r.template parameters<K>().for_guard(), s.template part<Set<K>>(),
                             mover.template set<Set<K>>())...);
    }
  };
  using All = Each<std::make_index_sequence<Robot::stiff_groups>>;
  struct Nothing {};
  /// Whether the robot is one group of joints, whose guard is the whole guard.
  static constexpr bool is_one = Robot::is_one_group;

 public:
  /// Trivially copyable.
  struct Memory {
    [[no_unique_address]] typename All::Memory stiff;
    [[no_unique_address]] std::conditional_t<Robot::has_driven, GuardMemory<Driven::count, T>, Nothing>
        driven;
  };

  /// Throws `ConfigurationError` as `JointGuard`.
  explicit Guard(const Robot& robot, const Settings& settings = {}, const Mover& mover = {})
      : settings_(settings), stiff_(All::make(robot, settings, mover)), driven_(driven_of(robot, settings)) {}

  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
  /// The guard of a robot that is one group.
  [[nodiscard]] SKINCTL_INLINE const auto& only() const noexcept
    requires(is_one)
  {
    if constexpr (Robot::has_driven) {
      return driven_;
    } else {
      return std::get<0>(stiff_);
    }
  }

  /// Takes over a robot with the command `command` in the state `measured`: `JointGuard::start` of all
  /// groups.
  [[nodiscard]] SKINCTL_COLD Memory start(const Command& command,
                                          const State<joints, T>& measured) const noexcept {
    Memory m;
    each(m, [&]<class S>(S, const auto& guard, auto& memory) {
      memory = guard.start(part_of<S>(command), part_of<S>(measured));
    });
    return m;
  }

  /// The command that may leave at the end of the interval, as `JointGuard::step`.
  SKINCTL_INLINE Guarded<joints, T> step(Memory& m, const Command& wish, const State<joints, T>& measured,
                                         const Interval& interval,
                                         const JointTorque<joints, T>& fallback = {},
                                         Status found = {}) const noexcept {
    if constexpr (is_one) {
      return only().step(only(m), wish, measured, interval, fallback, found);
    } else {
      Guarded<joints, T> out{wish, {}, false};
      out.command.valid = true;
      each(m, [&]<class S>(S, const auto& guard, auto& memory) {
        const auto one =
            guard.step(memory, part_of<S>(wish), part_of<S>(measured), interval, S::of(fallback), found);
        out.status |= one.status;
        out.altered = out.altered || one.altered;
        out.brakes = out.brakes || one.brakes;
        out.command.time = one.command.time;
        out.command.valid = out.command.valid && one.command.valid;
        put_part<S>(one.command, out.command);
      });
      return out;
    }
  }

  /// The last command that left.
  [[nodiscard]] SKINCTL_INLINE decltype(auto) last(const Memory& m) const noexcept {
    if constexpr (is_one) {
      return (only(m).command);
    } else {
      Command out;
      out.valid = true;
      each(m, [&]<class S>(S, const auto&, const auto& memory) {
        out.time = memory.command.time;
        out.valid = out.valid && memory.command.valid;
        put_part<S>(memory.command, out);
      });
      return out;
    }
  }
  /// Takes the user's consent for all groups: latched faults end, unless they are still present.
  void acknowledge(Memory& m) const noexcept {
    each(m, [](auto, const auto& guard, auto& memory) { guard.acknowledge(memory); });
  }
  /// Whether the robot waits for the user's consent.
  [[nodiscard]] SKINCTL_INLINE bool waits(const Memory& m) const noexcept {
    bool any = false;
    each(m, [&](auto, const auto& guard, const auto& memory) { any = any || guard.waits(memory); });
    return any;
  }
  /// Whether nothing passes until a guard is started anew.
  [[nodiscard]] SKINCTL_INLINE bool refuses_start(const Memory& m) const noexcept {
    bool any = false;
    each(m, [&](auto, const auto& guard, const auto& memory) { any = any || guard.refuses_start(memory); });
    return any;
  }
  /// Whether this robot can be in the state `s`.
  [[nodiscard]] SKINCTL_INLINE bool believes(const State<joints, T>& s) const noexcept {
    if constexpr (is_one) {
      return only().believes(s);
    } else {
      bool all = true;
      Robot::each([&](auto k) { all = all && std::get<k.value>(stiff_).believes(part_of<Set<k.value>>(s)); });
      if constexpr (Robot::has_driven) all = all && driven_.believes(part_of<Driven>(s));
      return all;
    }
  }

 private:
  using DrivenGuard =
      std::conditional_t<Robot::has_driven, JointGuard<Interface::torque, Driven::count, T>, Nothing>;

  [[nodiscard]] static DrivenGuard driven_of([[maybe_unused]] const Robot& robot,
                                             [[maybe_unused]] const Settings& settings) {
    if constexpr (Robot::has_driven) {
      return DrivenGuard(robot.for_guard(robot.limits().template part<Driven>()),
                         settings.template part<Driven>());
    } else {
      return {};
    }
  }
  template <class M>
  [[nodiscard]] static SKINCTL_INLINE auto& only(M& m) noexcept {
    if constexpr (Robot::has_driven) {
      return m.driven;
    } else {
      return detail::element<0>(m.stiff);
    }
  }
  /// Calls `f(set, guard, memory)` for each group.
  template <class M, class F>
  SKINCTL_INLINE void each(M& m, F&& f) const noexcept {
    Robot::each([&](auto k) SKINCTL_INLINE_LAMBDA {
      f(Set<k.value>{}, std::get<k.value>(stiff_), detail::element<k.value>(m.stiff));
    });
    if constexpr (Robot::has_driven) f(Driven{}, driven_, m.driven);
  }

  Settings settings_;
  [[no_unique_address]] typename All::Guards stiff_;
  [[no_unique_address]] DrivenGuard driven_;
};

SKINCTL_END_NAMESPACE
