// SPDX-License-Identifier: BSD-3-Clause
// Requests to a set of skills: another skill, another goal, or a report of the switches.
#pragma once

#include "skinctl/fusion/detail/memories.hpp"
#include "skinctl/law/law.hpp"
#include "skinctl/skills/skill.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// Goals of several types side by side, each optional.
template <class... G>
struct Goals {
  template <class X>
  struct NoSuchGoal {};
  template <class X>
  constexpr NoSuchGoal<X> of() const noexcept {
    return {};
  }
  template <class F>
  friend void each_number(Goals&, F&&) {}
};
template <class G, class... Rest>
struct Goals<G, Rest...> {
  bool has = false;
  G goal{};
  Goals<Rest...> rest;

  /// The part for goals of type `X`.
  template <class X>
  constexpr decltype(auto) of() noexcept {
    if constexpr (std::is_same_v<G, X>)
      return (*this);
    else
      return rest.template of<X>();
  }
  template <class X>
  constexpr decltype(auto) of() const noexcept {
    if constexpr (std::is_same_v<G, X>)
      return (*this);
    else
      return rest.template of<X>();
  }
  [[nodiscard]] constexpr bool any() const noexcept {
    if constexpr (sizeof...(Rest) > 0)
      return has || rest.any();
    else
      return has;
  }
  template <class F>
  friend void each_number(Goals& g, F&& f) {
    f(g.has);
    each_number(g.goal, f);
    each_number(g.rest, f);
  }
};
}  // namespace detail

/// A request to a set of skills whose controllers take goals of the types `G`. Made by `SkillSet::start`,
/// `goal` and `report`. Trivially copyable; any bits are allowed in it.
template <class... G>
struct SkillRequest {
  enum class Kind : unsigned char { start, goal, report };
  unsigned char kind = static_cast<unsigned char>(Kind::goal);
  std::uint8_t skill = 0;
  std::uint16_t ticket = 0;  ///< a number by which `SkillSet::report_of` tells what becomes of the request
  SkillSwitches reported;
  GoalTolerance tolerance;  ///< tolerance of the goals; 0: the skill's own
  detail::Goals<G...> goals;

  /// The request under a number of its sender's choice; 0 is no number.
  [[nodiscard]] constexpr SkillRequest with_ticket(std::uint16_t number) const noexcept {
    SkillRequest out = *this;
    out.ticket = number;
    return out;
  }
  /// The request whose skill is finished this near to its goals.
  [[nodiscard]] constexpr SkillRequest within(const GoalTolerance& near) const noexcept {
    SkillRequest out = *this;
    out.tolerance = near;
    return out;
  }

  template <class F>
  friend void each_number(SkillRequest& r, F&& f) {
    f(r.kind);
    f(r.skill);
    f(r.ticket);
    f(r.reported.which);
    f(r.reported.on);
    each_number(r.tolerance, f);
    each_number(r.goals, f);
  }
};

/// Calls `f` with the numbers of a gripper's goal, as a part of a request.
template <class F>
void each_number(GripperGoal& g, F&& f) {
  f(g.opening), f(g.force), f(g.speed);
}

namespace detail {
/// The goals that laws take, each type once.
template <class Found, class... L>
struct GoalTypes;
template <class... G>
struct GoalTypes<SkillRequest<G...>> {
  using type = SkillRequest<G...>;
};
template <class... G, class L, class... Rest>
struct GoalTypes<SkillRequest<G...>, L, Rest...> : GoalTypes<SkillRequest<G...>, Rest...> {};
template <class... G, HasGoal L, class... Rest>
  requires(!(std::is_same_v<G, typename L::Goal> || ...))
struct GoalTypes<SkillRequest<G...>, L, Rest...> : GoalTypes<SkillRequest<G..., typename L::Goal>, Rest...> {
};
}  // namespace detail

SKINCTL_END_NAMESPACE
