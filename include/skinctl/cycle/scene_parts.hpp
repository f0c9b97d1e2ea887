// Guard and governor of a scene, derived from the description of its robot, and comparison of parts given by
// hand with that description.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/governor.hpp"
#include "skinctl/limits/motion_limits.hpp"
#include "skinctl/resolver/resolver_of.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

/// A robot's description, the first argument of `Cycle`.
template <class R>
concept Described = requires { typename ResolverOf<R>::type; };

/// Whether a robot is one group of joints, which have one interface.
template <class Resolver>
inline constexpr bool has_one_interface = requires { Resolver::interface; };

/// Guard and governor of a robot whose joints are all of one kind. Those of a robot in groups: `cycle/groups.hpp`.
template <class Resolver>
struct SceneParts {
  static constexpr std::size_t joints = Resolver::joints;
  using T = typename Resolver::scalar;
  /// With `Smooth`, a guard that brakes within limits of jerk.
  template <class Smooth = NoPart>
  using Guard = skinctl::Guard<Resolver::interface, joints, T, Smooth>;

  /// @param more  settings of the guard, then limits of jerk.
  template <class Smooth = NoPart, class... More>
  [[nodiscard]] static Guard<Smooth> guard(const Resolver& r, const More&... more) {
    if constexpr (Resolver::has_virtual) {
      return Guard<Smooth>(r.parameters().for_guard(), more...);
    } else {
      return Guard<Smooth>(r.for_guard(r.limits()), more...);
    }
  }
  /// By torque the limits of the motion are added.
  template <class... Limits>
  [[nodiscard]] static auto governor(const Resolver& r, const Limits&... limits) {
    if constexpr (Resolver::interface == Interface::torque) {
      using M = std::remove_cvref_t<decltype(r.model())>;
      return make_governor(r.limits(), limits..., MotionLimits<M, T>(r.model()));
    } else if constexpr (sizeof...(Limits) > 0) {
      return make_governor(r.limits(), limits...);
    } else {
      return NoGovernor{};
    }
  }
};

/// A guard whose settings nobody has given yet: `Cycle::with` still takes some.
template <class Guard>
struct WithDefaults : Guard {
  explicit WithDefaults(const Guard& guard) : Guard(guard) {}
};
template <class Resolver>
using DefaultGuard = WithDefaults<typename SceneParts<Resolver>::template Guard<>>;
template <class Resolver>
[[nodiscard]] auto default_guard(const Resolver& r) {
  return WithDefaults(SceneParts<Resolver>::guard(r));
}
template <class Resolver>
[[nodiscard]] auto default_governor(const Resolver& r) {
  return SceneParts<Resolver>::governor(r);
}
template <class Resolver>
using DefaultGovernor = decltype(default_governor(std::declval<const Resolver&>()));

// A part of `with`, built for this robot by its `part_for`, which lies beside it. A part that is built already passes.
template <class Resolver, class Part>
[[nodiscard]] auto made_for(const Resolver& r, const Part& part) {
  if constexpr (requires { part_for(r.model(), r.limits(), part); }) {
    return part_for(r.model(), r.limits(), part);
  } else {
    return part;
  }
}
template <class Part>
inline constexpr bool is_guard_settings = false;
template <std::size_t N, Real T>
inline constexpr bool is_guard_settings<GuardSettings<N, T>> = true;

/// A part as a list of single parts: contact limits are one for each link; none for `NoPart`.
template <class Part>
[[nodiscard]] auto single(const Part& part) {
  if constexpr (std::is_same_v<Part, NoPart>) {
    return std::tuple<>();
  } else if constexpr (ContactPart<Part>) {
    return part.settings();
  } else {
    return std::tuple(part);
  }
}
/// The parts that a guard or a governor has been given. Limits of a motion by torque belong to the robot.
template <class Stage>
[[nodiscard]] auto parts_in(const Stage& stage) {
  if constexpr (requires { stage.clearance(); }) {
    return std::tuple_cat(single(stage.jerk()), single(stage.tool()), single(stage.contact()),
                          single(stage.watch()), single(stage.clearance()));
  } else if constexpr (requires { stage.settings(); }) {
    return std::tuple(stage.settings());
  } else {
    return std::tuple<>();
  }
}
template <class Guard>
[[nodiscard]] std::tuple<> parts_in(const WithDefaults<Guard>&) {
  return {};
}

/// Whether both are of one kind, of which a scene has at most one.
template <class A, class B>
inline constexpr bool same_kind = [] {
  if constexpr (is_link_contact<A> && is_link_contact<B>) {
    return A::link == B::link;
  } else {
    return (JerkPart<A> && JerkPart<B>) || (ToolPart<A> && ToolPart<B>) || (WatchPart<A> && WatchPart<B>) ||
           (ClearancePart<A> && ClearancePart<B>) || (is_guard_settings<A> && is_guard_settings<B>);
  }
}();
template <class Part, class... All>
inline constexpr int count_of_kind = (0 + ... + int(same_kind<Part, All>));
template <class Parts>
inline constexpr bool each_kind_once = false;
template <class... Parts>
inline constexpr bool each_kind_once<std::tuple<Parts...>> = ((count_of_kind<Parts, Parts...> <= 1) && ...);

/// A list of the part, if `Take` says so; else an empty one.
template <bool Take, class Part>
[[nodiscard]] auto if_taken([[maybe_unused]] const Part& part) {
  if constexpr (Take) {
    return std::tuple(part);
  } else {
    return std::tuple<>();
  }
}
/// Contact limits of the links, in their order; no part without links.
template <class Resolver, class... Contacts>
[[nodiscard]] auto joined(const Resolver& r, const std::tuple<Contacts...>& contacts) {
  if constexpr (sizeof...(Contacts) == 0) {
    return contacts;
  } else {
    constexpr auto order = [] {
      constexpr std::array<std::size_t, sizeof...(Contacts)> links{Contacts::link...};
      std::array<std::size_t, sizeof...(Contacts)> out{};
      for (std::size_t i = 0; i < links.size(); ++i) {
        std::size_t before = 0;
        for (const std::size_t link : links)
          if (link < links[i]) ++before;
        out[before] = i;
      }
      return out;
    }();
    return [&]<std::size_t... K>(std::index_sequence<K...>) {
      return std::tuple(
          contact_limits<typename Resolver::scalar>(r.model(), std::get<order[K]>(contacts)...));
    }(std::index_sequence_for<Contacts...>{});
  }
}
/// A governor of the parts that are limits, the contacts of all links joined into one.
template <class Resolver, class... Parts>
[[nodiscard]] auto governor_of(const Resolver& r, const std::tuple<Parts...>& parts) {
  return std::apply(
      [&](const auto&... p) {
        const auto contacts = std::tuple_cat(if_taken<is_link_contact<Parts>>(p)...);
        const auto others =
            std::tuple_cat(if_taken < !is_link_contact<Parts> && !is_guard_settings < Parts >> (p)...);
        return std::apply([&](const auto&... limit) { return SceneParts<Resolver>::governor(r, limit...); },
                          std::tuple_cat(others, joined(r, contacts)));
      },
      parts);
}
/// A guard with the settings among the parts; it brakes within the limits of jerk of `governor`, if there are some.
template <class Resolver, class... Parts, class Governor>
[[nodiscard]] auto guard_of(const Resolver& r, const std::tuple<Parts...>& parts, const Governor& governor) {
  using Settings = typename SceneParts<Resolver>::template Guard<>::Settings;
  static_assert(((!is_guard_settings<Parts> || std::is_same_v<Parts, Settings>) && ...),
                "GuardSettings: of another robot or scalar");
  const auto with = [&](const Settings& settings) {
    if constexpr (requires { requires Governor::has_jerk; }) {
      using Smooth = std::remove_cvref_t<decltype(governor.jerk())>;
      return SceneParts<Resolver>::template guard<Smooth>(r, settings, governor.jerk());
    } else {
      return SceneParts<Resolver>::guard(r, settings);
    }
  };
  if constexpr ((std::is_same_v<Parts, Settings> || ...)) {
    return with(std::get<Settings>(parts));
  } else {
    return WithDefaults(with(Settings{}));
  }
}

/// Faults of a guard that is given by hand.
enum class GuardFault { none, interface, joints, scalar };
template <class Guard, class Resolver>
consteval GuardFault fault_in_guard() {
  if constexpr (requires {
                  { Guard::interface } -> std::convertible_to<Interface>;
                  { Resolver::interface } -> std::convertible_to<Interface>;
                }) {
    if (Guard::interface != Resolver::interface) return GuardFault::interface;
    if (Guard::joints != Resolver::joints) return GuardFault::joints;
    if (!std::is_same_v<typename Guard::scalar, typename Resolver::scalar>) return GuardFault::scalar;
  }
  return GuardFault::none;
}

/// Throws `ConfigurationError` with both values where two parts of a scene state a fact differently.
SKINCTL_COLD inline void require_same(const char* what, double here, double there, const char* unit,
                                      const char* where = "in the guard",
                                      const char* elsewhere = "in the robot's description") {
  if (here == there) return;
  char text[192];
  std::snprintf(text, sizeof text, "skinctl: %s: %.9g %s %s, %.9g %s %s", what, here, unit, where, there,
                unit, elsewhere);
  refuse(text);
}
template <class Guard, class Resolver>
SKINCTL_COLD void compare(const Guard& guard, const Resolver& resolver) {
  if constexpr (requires { guard.limits(); } && fault_in_guard<Guard, Resolver>() == GuardFault::none) {
    const auto& ours = guard.limits();
    const auto& theirs = resolver.limits();
    const auto number = [](const auto& x) { return static_cast<double>(x); };
    for (std::size_t i = 0; i < Resolver::joints; ++i) {
      require_same("lower position limit", number(ours.lower()[i]), number(theirs.lower()[i]), "rad");
      require_same("upper position limit", number(ours.upper()[i]), number(theirs.upper()[i]), "rad");
      require_same("velocity limit", number(ours.velocity()[i]), number(theirs.velocity()[i]), "rad/s");
      require_same("acceleration limit", number(ours.acceleration()[i]), number(theirs.acceleration()[i]),
                   "rad/s^2");
      require_same("torque limit", number(ours.torque()[i]), number(theirs.torque()[i]), "N m");
    }
    require_same("period", milliseconds(guard.period()), milliseconds(resolver.period()), "ms");
    require_same("longest interval", milliseconds(guard.longest_interval()),
                 milliseconds(resolver.longest_interval()), "ms");
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
