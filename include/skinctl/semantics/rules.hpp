// SPDX-License-Identifier: BSD-3-Clause
// Activities from features by rules: the corrected set of TUM's, which remembers.
#pragma once

#include "skinctl/semantics/features.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The activity of a hand by the rules.
enum class Activity : std::uint8_t { unknown, idle, reach, take, hold, put, squeeze, use, release };
inline constexpr std::size_t activities = 9;

[[nodiscard]] constexpr const char* describe(Activity a) noexcept {
  constexpr const char* words[activities] = {"unknown", "idle",    "reach",      "take",   "hold",
                                             "put",     "squeeze", "use a tool", "release"};
  return static_cast<std::size_t>(a) < activities ? words[static_cast<std::size_t>(a)] : words[0];
}

/// The rules, the first that applies; in hand: squeezed: squeeze; a tool that moves near another object: use;
/// moving: put; carried: hold; else take. Not in hand: not left yet: release; moving: reach; else idle.
///
/// `carried` and `left` are the memory of the rules: without them take and hold, idle and release look the
/// same.
struct Rules {
  [[nodiscard]] constexpr Activity operator()(const Features& f) const noexcept {
    if (!f.known) return Activity::unknown;
    if (f.in_hand) {
      if (f.squeezed) return Activity::squeeze;
      if (f.tool && f.moving) return Activity::use;
      if (f.moving) return Activity::put;
      return f.carried ? Activity::hold : Activity::take;
    }
    if (!f.left) return Activity::release;
    return f.moving ? Activity::reach : Activity::idle;
  }
};

/// The name of the use of a tool on an object, by their classes: a knife and bread, "cut".
struct ToolUse {
  ObjectClass tool = 0, object = 0;
  const char* name = "";
};
/// The name of what a tool does, or "use a tool". `uses`: a range of `ToolUse`.
template <class Uses>
[[nodiscard]] constexpr const char* describe_use(const Features& f, const Uses& uses) noexcept {
  for (const ToolUse& u : uses)
    if (u.tool == f.held_kind && u.object == f.near_kind) return u.name;
  return describe(Activity::use);
}

SKINCTL_END_NAMESPACE
