// SPDX-License-Identifier: BSD-3-Clause
// Guard and governor of a scene, built from its list of parts.
#pragma once

#include <tuple>

#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/governor.hpp"
#include "skinctl/limits/motion_limits.hpp"
#include "skinctl/resolver/resolver_of.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

template <class Part>
concept GivenGuardSettings = std::is_same_v<typename KindOf<Part>::type, GuardPart>;
/// Settings of a limit, whose `part_for` lies beside them.
template <class Part, class Robot>
concept MakesLimit = requires(const Robot& r, const Part& part) { part_for(r.model(), r.limits(), part); };

/// The limit of a robot that settings make together; a limit that is built already passes.
template <class Robot, class Part, class... Others>
[[nodiscard]] auto limit_of(const Robot& r, const Part& part, const Others&... others) {
  if constexpr (sizeof...(Others) > 0 || MakesLimit<Part, Robot>) {
    return part_for(r.model(), r.limits(), part, others...);
  } else {
    return part;
  }
}
/// Settings of one family make one limit: the contacts of all links.
template <class Part>
struct FamilyOf {
  using type = typename KindOf<Part>::type;
};
template <class Part>
concept PartOfFamily = requires { typename Part::Family; };
template <PartOfFamily Part>
struct FamilyOf<Part> {
  using type = typename Part::Family;
};
template <class Part, class Family>
inline constexpr bool is_of = std::is_same_v<typename FamilyOf<Part>::type, Family>;

/// A list of the part, if `Take` says so; else an empty one.
template <bool Take, class Part>
[[nodiscard]] auto if_taken([[maybe_unused]] const Part& part) {
  if constexpr (Take) {
    return std::tuple<const Part&>(part);
  } else {
    return std::tuple<>();
  }
}
/// The limits of a robot that `parts` make, from the index `K` on; each family where its first part stands.
template <std::size_t K = 0, class Robot, class... Parts>
[[nodiscard]] auto limits_of_parts(const Robot& r, const std::tuple<Parts...>& parts) {
  if constexpr (K == sizeof...(Parts)) {
    return std::tuple<>();
  } else {
    using Part = std::tuple_element_t<K, std::tuple<Parts...>>;
    using Family = typename FamilyOf<Part>::type;
    constexpr std::size_t first = place_of<sizeof...(Parts)>({is_of<Parts, Family>...});
    if constexpr (GivenGuardSettings<Part> || first < K) {
      return limits_of_parts<K + 1>(r, parts);
    } else {
      const auto together = std::apply(
          [](const auto&... p) { return std::tuple_cat(if_taken<is_of<Parts, Family>>(p)...); }, parts);
      return std::tuple_cat(
          std::tuple(std::apply([&](const auto&... p) { return limit_of(r, p...); }, together)),
          limits_of_parts<K + 1>(r, parts));
    }
  }
}
/// The governor of a scene.
template <class Robot, class... Parts>
[[nodiscard]] auto governor_of(const Robot& r, const std::tuple<Parts...>& parts) {
  return std::apply(
      [&](const auto&... limit) {
        return make_governor<typename Robot::JointSets>(r.model(), r.limits(), limit...);
      },
      limits_of_parts(r, parts));
}
template <class Robot, class Parts>
using GovernorOf = decltype(governor_of(std::declval<const Robot&>(), std::declval<const Parts&>()));

/// The limit that decides how the joints of a scene move, or `Abrupt`: a guard brakes by it.
template <class Governor>
[[nodiscard]] auto motion_limit_of(const Governor& governor) {
  if constexpr (Governor::smooth) {
    return governor.mover();
  } else {
    return Abrupt{};
  }
}
/// The guard of a scene, with the settings among its parts.
template <class Robot, class... Parts, class Governor>
[[nodiscard]] auto guard_of(const Robot& r, const std::tuple<Parts...>& parts, const Governor& governor) {
  using Settings = GuardSettings<Robot::joints, typename Robot::scalar>;
  static_assert(((!GivenGuardSettings<Parts> || std::is_same_v<Parts, Settings>) && ...),
                "GuardSettings: of another robot or scalar");
  const auto mover = motion_limit_of(governor);
  using Made = Guard<Robot, std::remove_const_t<decltype(mover)>>;
  if constexpr ((std::is_same_v<Parts, Settings> || ...)) {
    return Made(r, std::get<Settings>(parts), mover);
  } else {
    return Made(r, Settings{}, mover);
  }
}
template <class Robot, class Parts>
using GuardOf = decltype(guard_of(std::declval<const Robot&>(), std::declval<const Parts&>(),
                                  std::declval<const GovernorOf<Robot, Parts>&>()));

/// The parts that a scene of a robot has before any is given.
template <class Robot>
using DefaultParts = std::conditional_t<Robot::has_driven,
                                        std::tuple<WithinJointLimits<typename Robot::Driven>>, std::tuple<>>;

template <class Part, class... All>
inline constexpr int count_of_kind = (0 + ... + int(of_kind<Part, All>));
/// Whether there is at most one part of each kind.
template <class Parts>
inline constexpr bool each_kind_once = false;
template <class... Parts>
inline constexpr bool each_kind_once<std::tuple<Parts...>> = ((count_of_kind<Parts, Parts...> <= 1) && ...);
/// The key by which the parts of a scene are ordered: the precedence of the part's limit, and among contacts
/// of several links the link.
template <class Robot, class Part>
[[nodiscard]] consteval std::size_t place_in_list() {
  if constexpr (GivenGuardSettings<Part>) {
    return 0;
  } else {
    using Limit = decltype(limit_of(std::declval<const Robot&>(), std::declval<const Part&>()));
    std::size_t place = (static_cast<std::size_t>(Limit::precedence) + 1) << 16;
    if constexpr (PartOfFamily<Part>) place += Part::link;
    return place;
  }
}
/// The list in the order of its limits, so that the order in which parts were given is in no type.
template <class Robot, class... Parts>
[[nodiscard]] auto in_list_order(const std::tuple<Parts...>& parts) {
  constexpr std::array<std::size_t, sizeof...(Parts)> order =
      order_of(std::array<std::size_t, sizeof...(Parts)>{place_in_list<Robot, Parts>()...});
  return [&]<std::size_t... K>(std::index_sequence<K...>) {
    return std::tuple<std::tuple_element_t<order[K], std::tuple<Parts...>>...>(std::get<order[K]>(parts)...);
  }(std::index_sequence_for<Parts...>{});
}
/// `parts` without those of the kind.
template <class Kind, class... Parts>
[[nodiscard]] auto without_kind(const std::tuple<Parts...>& parts) {
  return std::apply(
      [](const auto&... p) {
        const auto left = std::tuple_cat(if_taken<!of_kind<Parts, Kind>>(p)...);
        return std::apply([](const auto&... l) { return std::tuple(l...); }, left);
      },
      parts);
}

/// Throws `ConfigurationError` with both values where two parts of a scene state a fact differently.
SKINCTL_COLD inline void require_same(const char* what, double here, double there, const char* unit,
                                      const char* where, const char* elsewhere) {
  if (here == there) return;
  char text[192];
  std::snprintf(text, sizeof text, "skinctl: %s: %.9g %s %s, %.9g %s %s", what, here, unit, where, there,
                unit, elsewhere);
  refuse(text);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
