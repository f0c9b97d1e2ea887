// A learnt task as JSON that loads again.
#pragma once

#include <span>

#include "examples/teach/recording.hpp"

namespace teach {

inline constexpr std::size_t max_steps = 48;
using Task = skinctl::TaughtTask<max_steps>;

/// A task, the words for its classes, and the ways of tools in use.
struct NamedTask {
  Task task{};
  Classes classes;
  skinctl::TaughtWays ways{};
};

/// What a robot can do besides the library's activities: their names may stand in files.
using Activities = std::span<const skinctl::ActivityRule* const>;

/// The task as JSON: steps by the names of their activities, edges by number or "finish", "ask", "nowhere";
/// places in metres, with rotation vectors, and the corners of the way where a tool is used; borders [N/m];
/// the facts with which it begins, if it is a part of a process.
[[nodiscard]] std::string to_json(const NamedTask& task);
/// Reads it back. Throws `std::runtime_error` for what is no task of this form, or one that `check` refuses;
/// at most 1 MB. Without activities of its own every step but look has a place.
[[nodiscard]] NamedTask from_json(const std::string& json, Activities own = {});
/// From a file.
[[nodiscard]] NamedTask load(const std::string& file, Activities own = {});
/// Facts by their names in files: "in_hand, good".
[[nodiscard]] std::string to_text(skinctl::Facts set);

/// One round of a task that is done until nothing is left: it ends where that one begins anew. For a process, whose
/// tasks take turns.
[[nodiscard]] Task one_round(Task task);

}  // namespace teach
