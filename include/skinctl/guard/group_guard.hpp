// The guard of a robot whose joints have several interfaces: one guard for each group.
#pragma once

#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/group_governor.hpp"
#include "skinctl/resolver/resolver.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
template <bool Smooth, std::size_t N, Real T>
using BrakingOf = std::conditional_t<Smooth, JerkLimits<N, T>, NoPart>;
}  // namespace detail

/// A `Guard` for each group of joints by position or velocity of a `Resolver`, and one for the joints by
/// torque. Each reacts to faults of its own joints and to those that other stages found; a fault of one
/// that waits for consent stops all, by the resolver, until `acknowledge`.
///
/// `GroupGuard<Resolver>(resolver, settings)`: limits and periods are the resolver's; the settings are those of
/// the whole robot. Throws `ConfigurationError` as `Guard`.
///
/// @tparam Smooth  the joints by position or velocity brake within limits of jerk.
template <class Robot, bool Smooth = false>
class GroupGuard {
 public:
  static constexpr std::size_t joints = Robot::joints;
  static constexpr bool smooth = Smooth;
  using Driven = typename Robot::Driven;
  using scalar = typename Robot::scalar;
  using T = scalar;
  using Settings = GuardSettings<joints, T>;

 private:
  template <std::size_t K>
  using Set = typename Robot::template Part<K>;
  template <std::size_t K>
  using Stiff = Guard<Robot::template Group<K>::interface, Set<K>::count, T,
                      detail::BrakingOf<Smooth, Set<K>::count, T>>;
  template <class Indices>
  struct Each;
  template <std::size_t... K>
  struct Each<std::index_sequence<K...>> {
    using Guards = std::tuple<Stiff<K>...>;
    using Memory = detail::PlainTuple<std::index_sequence<K...>, GuardMemory<Set<K>::count, T>...>;
    template <class Braking>
    static Guards make(const Robot& r, const Settings& s, const Braking& braking) {
      return Guards(Stiff<K>(r.template parameters<K>().for_guard(), part<Set<K>>(s),
                             braking.template of<Set<K>>())...);
    }
  };
  using All = Each<std::make_index_sequence<Robot::stiff_groups>>;
  struct Nothing {};
  struct Abrupt {
    template <class>
    [[nodiscard]] detail::NoPart of() const {
      return {};
    }
  };
  struct Gentle {
    const JointLimits<joints, T>& limits;
    const JointJerk<joints, T>& jerk;
    template <class S>
    [[nodiscard]] auto of() const {
      return JerkLimits<S::count, T>(detail::limits_of_part<S>(limits), S::of(jerk));
    }
  };

 public:
  /// Trivially copyable.
  struct Memory {
    typename All::Memory stiff;
    [[no_unique_address]] std::conditional_t<Robot::has_driven, GuardMemory<Driven::count, T>, Nothing>
        driven;
  };

  explicit GroupGuard(const Robot& robot, const Settings& settings = {})
    requires(!Smooth)
      : GroupGuard(robot, settings, Abrupt{}) {}
  GroupGuard(const Robot& robot, const Settings& settings, const JointJerk<joints, T>& jerk)
    requires Smooth
      : GroupGuard(robot, settings, Gentle{robot.limits(), jerk}) {}

  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }

  /// As `Guard::start`, for all groups.
  [[nodiscard]] SKINCTL_COLD Memory start(const JointCommand<joints, T>& command,
                                          const State<joints, T>& measured) const noexcept {
    Memory m;
    each([&](auto k) {
      using S = Set<k.value>;
      detail::element<k.value>(m.stiff) =
          std::get<k.value>(stiff_).start(part_of<S>(command), part_of<S>(measured));
    });
    if constexpr (Robot::has_driven)
      m.driven = driven_.start(part_of<Driven>(command), part_of<Driven>(measured));
    return m;
  }

  /// The command that may leave at `now`, as `Guard::step`.
  Guarded<joints, T> step(Memory& m, const JointCommand<joints, T>& wish, const State<joints, T>& measured,
                          Nanoseconds now, const JointTorque<joints, T>& fallback = {},
                          Status found = {}) const noexcept {
    Guarded<joints, T> out{wish, {}, false};
    const auto take = [&](auto set, const auto& guarded) {
      using S = decltype(set);
      out.status |= guarded.status;
      out.altered = out.altered || guarded.altered;
      out.command.time = guarded.command.time;
      out.command.valid = out.command.valid && guarded.command.valid;
      put_part<S>(guarded.command, out.command);
    };
    out.command.valid = true;
    each([&](auto k) {
      using S = Set<k.value>;
      take(S{}, std::get<k.value>(stiff_).step(detail::element<k.value>(m.stiff), part_of<S>(wish),
                                               part_of<S>(measured), now, {}, found));
    });
    if constexpr (Robot::has_driven)
      take(Driven{}, driven_.step(m.driven, part_of<Driven>(wish), part_of<Driven>(measured), now,
                                  Driven::of(fallback), found));
    return out;
  }

  /// The last command that left.
  [[nodiscard]] JointCommand<joints, T> last(const Memory& m) const noexcept {
    JointCommand<joints, T> out;
    out.valid = true;
    each([&](auto k) {
      const auto& c = detail::element<k.value>(m.stiff).command;
      out.time = c.time;
      out.valid = out.valid && c.valid;
      put_part<Set<k.value>>(c, out);
    });
    if constexpr (Robot::has_driven) {
      out.valid = out.valid && m.driven.command.valid;
      put_part<Driven>(m.driven.command, out);
    }
    return out;
  }
  /// The user's consent, to all.
  void acknowledge(Memory& m) const noexcept {
    each([&](auto k) { std::get<k.value>(stiff_).acknowledge(detail::element<k.value>(m.stiff)); });
    if constexpr (Robot::has_driven) driven_.acknowledge(m.driven);
  }
  [[nodiscard]] static bool waits(const Memory& m) noexcept {
    bool any = false;
    each([&](auto k) { any = any || Stiff<k.value>::waits(detail::element<k.value>(m.stiff)); });
    if constexpr (Robot::has_driven) any = any || DrivenGuard::waits(m.driven);
    return any;
  }
  [[nodiscard]] static bool refuses_start(const Memory& m) noexcept {
    bool any = false;
    each([&](auto k) { any = any || Stiff<k.value>::refuses_start(detail::element<k.value>(m.stiff)); });
    if constexpr (Robot::has_driven) any = any || DrivenGuard::refuses_start(m.driven);
    return any;
  }
  /// Whether this robot can be in the state `s`.
  [[nodiscard]] bool believes(const State<joints, T>& s) const noexcept {
    bool all = true;
    each([&](auto k) { all = all && std::get<k.value>(stiff_).believes(part_of<Set<k.value>>(s)); });
    if constexpr (Robot::has_driven) all = all && driven_.believes(part_of<Driven>(s));
    return all;
  }

 private:
  using DrivenGuard =
      std::conditional_t<Robot::has_driven, Guard<Interface::torque, Driven::count, T>, Nothing>;
  template <class Braking>
    requires requires(const Braking& b) { b.template of<Set<0>>(); }
  GroupGuard(const Robot& robot, const Settings& settings, const Braking& braking)
      : settings_(settings),
        stiff_(All::make(robot, settings, braking)),
        driven_(driven_of(robot, settings)) {}

  [[nodiscard]] static DrivenGuard driven_of([[maybe_unused]] const Robot& robot,
                                             [[maybe_unused]] const Settings& settings) {
    if constexpr (Robot::has_driven) {
      return DrivenGuard(robot.for_guard(detail::limits_of_part<Driven>(robot.limits())),
                         part<Driven>(settings));
    } else {
      return {};
    }
  }
  template <class S>
  [[nodiscard]] static GuardSettings<S::count, T> part(const Settings& s) {
    GuardSettings<S::count, T> out{.torque_rate = s.torque_rate,
                                   .beyond = s.beyond,
                                   .overspeed = s.overspeed,
                                   .brakes_on = s.brakes_on,
                                   .consent = s.consent};
    if (s.stale_after) out.stale_after = *s.stale_after;  // GCC 12 takes a copy of an empty one for a use
    if (s.lead) out.lead = S::of(*s.lead);
    return out;
  }
  template <class F>
  static SKINCTL_INLINE void each(F&& f) noexcept {
    Robot::each(std::forward<F>(f));
  }

  Settings settings_;
  typename All::Guards stiff_;
  [[no_unique_address]] DrivenGuard driven_;
};
template <class Robot>
GroupGuard(const Robot&) -> GroupGuard<Robot>;
template <class Robot>
GroupGuard(const Robot&, const GuardSettings<Robot::joints, typename Robot::scalar>&) -> GroupGuard<Robot>;

SKINCTL_END_NAMESPACE
