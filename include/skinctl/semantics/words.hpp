// SPDX-License-Identifier: BSD-3-Clause
// The words for what a hand does.
#pragma once

#include "skinctl/semantics/features.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The activity of a hand.
enum class Activity : std::uint8_t { unknown, idle, reach, take, hold, put, squeeze, use, release };
inline constexpr std::size_t activities = 9;

[[nodiscard]] constexpr const char* describe(Activity a) noexcept {
  constexpr const char* words[activities] = {"unknown", "idle",    "reach",      "take",   "hold",
                                             "put",     "squeeze", "use a tool", "release"};
  return static_cast<std::size_t>(a) < activities ? words[static_cast<std::size_t>(a)] : words[0];
}

/// The name of the use of a tool on an object, by their classes: a knife and bread, "cut".
struct ToolUse {
  ObjectClass tool = 0, object = 0;
  const char* name = "";
};
/// The name that `uses`, a range of `ToolUse`, gives to the tool in hand and the object near it; else "use a
/// tool".
template <class Uses>
[[nodiscard]] constexpr const char* describe_use(const Features& f, const Uses& uses) noexcept {
  for (const ToolUse& u : uses)
    if (u.tool == f.held_kind && u.object == f.near_kind) return u.name;
  return describe(Activity::use);
}

SKINCTL_END_NAMESPACE
