// SPDX-License-Identifier: BSD-3-Clause
// From activities to a robot's behaviours: the bridge from what a task means to what a robot does.
#pragma once

#include "skinctl/core/detail/hana.hpp"
#include "skinctl/semantics/task.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An entry of a robot's map, a map of Hana from activities to behaviours:
///
///     constexpr auto my_robot = boost::hana::make_map(done_by<activity::Reach, behaviour::Reaching>(), ...);
template <PlannedActivity A, class Behaviour>
[[nodiscard]] constexpr auto done_by() noexcept {
  return boost::hana::make_pair(boost::hana::type_c<A>, boost::hana::type_c<Behaviour>);
}

namespace task_error {
inline void the_robot_has_no_behaviour_for_an_activity(std::size_t) {}
inline void the_robot_has_no_behaviour_to_go_back(std::size_t) {}
}  // namespace task_error

/// The skill of each activity, as an index into a robot's set of skills.
template <std::size_t N>
struct SkillMap {
  struct Row {
    const ActivityRule* does = nullptr;
    std::uint8_t skill = 0;
  };
  std::array<Row, N> rows{};

  static constexpr std::uint8_t none = 255;
  /// Index of the skill of an activity in the set, or `none`.
  [[nodiscard]] constexpr std::uint8_t operator()(const ActivityRule* does) const noexcept {
    for (const Row& r : rows)
      if (r.does == does) return r.skill;
    return none;
  }
};

/// The map for a set of skills: `skill_map<decltype(skills)>(my_robot, my_task)`. A behaviour that the set
/// lacks, or an activity of the task that the map lacks, does not compile.
template <class Set, class Map, std::size_t N>
[[nodiscard]] consteval auto skill_map(const Map&, const TaughtTask<N>& task) {
  namespace hana = boost::hana;
  constexpr std::size_t size = decltype(hana::length(std::declval<Map>()))::value;
  SkillMap<size> out{};
  using Keys = decltype(hana::keys(std::declval<const Map&>()));
  std::size_t i = 0;
  hana::unpack(Keys{}, [&](auto... key) {
    const auto one = [&](auto k) {
      using Behaviour =
          typename std::remove_cvref_t<decltype(hana::at_key(std::declval<const Map&>(), k))>::type;
      out.rows[i++] = {&decltype(k)::type::rule, Set::template index<Behaviour>()};
    };
    (one(key), ...);
  });
  for (std::size_t k = 0; k < task.size; ++k)
    if (out(task.steps[k].does) == out.none) task_error::the_robot_has_no_behaviour_for_an_activity(k);
  if (out(&activity::Reverse::rule) == out.none) task_error::the_robot_has_no_behaviour_to_go_back(0);
  return out;
}

SKINCTL_END_NAMESPACE
