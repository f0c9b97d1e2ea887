// Guard and governor of a scene, derived from the description of its robot, and comparison of parts given by
// hand with that description.
#pragma once

#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/governor.hpp"
#include "skinctl/limits/motion_limits.hpp"
#include "skinctl/resolver/resolver_of.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

/// A robot's description, the first argument of `Cycle`.
template <class R>
concept Described = requires { typename ResolverOf<R>::type; };

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
    const auto& p = r.parameters();
    return Guard<Smooth>(
        RobotConfiguration<joints, T>{
            .limits = p.limits, .period = p.period, .longest_interval = p.longest_interval},
        more...);
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

template <class Resolver>
using DefaultGuard = typename SceneParts<Resolver>::template Guard<>;
template <class Resolver>
[[nodiscard]] auto default_guard(const Resolver& r) {
  return SceneParts<Resolver>::guard(r);
}
template <class Resolver>
[[nodiscard]] auto default_governor(const Resolver& r) {
  return SceneParts<Resolver>::governor(r);
}
template <class Resolver>
using DefaultGovernor = decltype(default_governor(std::declval<const Resolver&>()));
/// A guard with these settings; it brakes within the limits of jerk of `limits`, if that governor has some.
template <class Resolver, class Settings, class Limits>
[[nodiscard]] auto guard_for(const Resolver& r, const Settings& settings, const Limits& limits) {
  if constexpr (requires { requires Limits::has_jerk; }) {
    using Smooth = std::remove_cvref_t<decltype(limits.jerk())>;
    return SceneParts<Resolver>::template guard<Smooth>(r, settings, limits.jerk());
  } else {
    return SceneParts<Resolver>::guard(r, settings);
  }
}

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

/// The settings of the guard among the parts, or the default.
template <class Settings>
[[nodiscard]] Settings guard_settings_in(const Settings& otherwise) {
  return otherwise;
}
template <class Settings, class First, class... Rest>
[[nodiscard]] Settings guard_settings_in(const Settings& otherwise, const First& first, const Rest&... rest) {
  if constexpr (is_guard_settings<First>) {
    static_assert(std::is_same_v<First, Settings>, "GuardSettings: of another robot or scalar");
    return first;
  } else {
    return guard_settings_in(otherwise, rest...);
  }
}

/// A governor of the parts, the contacts of the links joined into one.
template <class Resolver, class... Made>
[[nodiscard]] auto governor_of(const Resolver& r, const std::tuple<Made...>& made) {
  return std::apply([&](const auto&... p) { return SceneParts<Resolver>::governor(r, p...); }, made);
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
    const auto& theirs = resolver.parameters().limits;
    const auto number = [](const auto& x) { return static_cast<double>(x); };
    for (std::size_t i = 0; i < Resolver::joints; ++i) {
      require_same("lower position limit", number(ours.lower()[i]), number(theirs.lower()[i]), "rad");
      require_same("upper position limit", number(ours.upper()[i]), number(theirs.upper()[i]), "rad");
      require_same("velocity limit", number(ours.velocity()[i]), number(theirs.velocity()[i]), "rad/s");
      require_same("acceleration limit", number(ours.acceleration()[i]), number(theirs.acceleration()[i]),
                   "rad/s^2");
      require_same("torque limit", number(ours.torque()[i]), number(theirs.torque()[i]), "N m");
    }
    require_same("period", milliseconds(guard.period()), milliseconds(resolver.parameters().period), "ms");
    require_same("longest interval", milliseconds(guard.longest_interval()),
                 milliseconds(resolver.parameters().longest_interval), "ms");
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
