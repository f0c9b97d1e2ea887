// SPDX-License-Identifier: BSD-3-Clause
// A library (a map of behaviours to recipes) and a robot's controllers become one law.
#pragma once

#include "skinctl/core/detail/hana.hpp"
#include "skinctl/skills/behaviours.hpp"
#include "skinctl/skills/skill_set.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A law with its name in recipes.
template <class Name, class L>
struct SkillController {
  using name = Name;
  L law;
};
template <class Name, class L>
[[nodiscard]] SkillController<Name, L> skill_controller(const L& law) {
  return {law};
}

namespace detail {
template <class... Name>
struct Bank {
  static constexpr std::size_t size = sizeof...(Name);
  template <class N>
  static constexpr std::size_t index = Behaviours<Name...>::template index<N>;
  /// Whether all controllers of a recipe, and of the recipes that follow it, are given.
  template <class Library, std::size_t Depth = 16, class Next, class... C>
  static constexpr bool can(const SkillRecipe<Next, C...>*) noexcept {
    constexpr bool all = ((index<C> < size) && ...);
    if constexpr (all && !std::is_void_v<Next> && Depth > 0) {
      using After = decltype(boost::hana::at_key(std::declval<const Library&>(), boost::hana::type_c<Next>));
      return can<Library, Depth - 1>(static_cast<std::remove_cvref_t<After>*>(nullptr));
    } else {
      return all;
    }
  }
};

template <class Bank, class Names, class Next, class... C>
constexpr Skill<Bank::size> row(const char* name, std::size_t own,
                                const SkillRecipe<Next, C...>& r) noexcept {
  Skill<Bank::size> s;
  s.name = name;
  s.switches = r.switches;
  s.conditions = r.conditions;
  s.grips = r.grips;
  s.grip = r.grip;
  std::size_t k = 0;
  const auto one = [&](std::size_t i) {
    s.order[k] = static_cast<std::uint8_t>(i);
    s.weights[i] = r.weights[k++];
  };
  (one(Bank::template index<C>), ...);
  s.controllers = static_cast<std::uint8_t>(sizeof...(C));
  if constexpr (std::is_void_v<Next>) {
    s.next = static_cast<std::uint8_t>(own);
  } else {
    s.next = static_cast<std::uint8_t>(Names::template index<Next>);
  }
  return s;
}

template <class First, class Grip, class Library, class... Name, class... L>
[[nodiscard]] auto skill_set_with(const Grip& gripper, const Library& library, const SkillSettings& settings,
                                  const SkillController<Name, L>&... controllers) {
  namespace hana = boost::hana;
  static_assert(((sizeof(Say<fault_in_members<L>(), L>) > 0) && ...));
  using Bank = Bank<Name...>;
  const auto known = hana::filter(hana::to_tuple(library), [](const auto& entry) {
    return hana::bool_c<Bank::template can<Library>(
        static_cast<std::remove_cvref_t<decltype(hana::second(entry))>*>(nullptr))>;
  });
  return hana::unpack(known, [&](const auto&... entry) {
    // The first of the set comes first; the others keep their order.
    const auto behaviours =
        hana::concat(hana::make_tuple(hana::type_c<First>),
                     hana::filter(hana::make_tuple(hana::first(entry)...), [](auto b) {
                       return hana::bool_c<!std::is_same_v<typename decltype(b)::type, First>>;
                     }));
    return hana::unpack(behaviours, [&](auto... b) {
      using Names = Behaviours<typename decltype(b)::type...>;
      static_assert(Names::count == sizeof...(entry),
                    "the first skill is not in the library, or lacks a controller");
      using Fusion = Fused<Sum::normalised, complete_law<L>...>;
      const Fusion sum(typename Fusion::Laws(controllers.law...), {((void)controllers, 1.0)...});
      return SkillSet<Names, Fusion, Grip>(
          sum,
          {row<Bank, Names>(decltype(b)::type::name, Names::template index<typename decltype(b)::type>,
                            hana::at_key(library, b))...},
          settings, gripper);
    });
  });
}
}  // namespace detail

/// The skills of `library` whose controllers are all given, as a law:
///
///     skill_set<First>(library, settings, skill_controller<controller::SplineJoint>(law), ...)
///
/// `First` is the initial behaviour and the fallback. Throws `ConfigurationError` for numbers out of range.
template <class First, class Library, class... Name, class... L>
[[nodiscard]] auto skill_set(const Library& library, const SkillSettings& settings,
                             const SkillController<Name, L>&... controllers) {
  return detail::skill_set_with<First>(NoGripper{}, library, settings, controllers...);
}
/// A `skill_set` with a gripper: `skill_set<First>(library, settings, OneGripper(range),
/// skill_controller...)`.
template <class First, class Library, class... Name, class... L>
[[nodiscard]] auto skill_set(const Library& library, const SkillSettings& settings, const OneGripper& gripper,
                             const SkillController<Name, L>&... controllers) {
  return detail::skill_set_with<First>(gripper, library, settings, controllers...);
}

SKINCTL_END_NAMESPACE
