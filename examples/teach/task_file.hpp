// A learnt task as JSON that loads again.
#pragma once

#include "examples/teach/recording.hpp"

namespace teach {

inline constexpr std::size_t max_steps = 48;
using Task = skinctl::TaughtTask<max_steps>;

/// A task, and the words for its classes.
struct NamedTask {
  Task task{};
  Classes classes;
};

/// The task as JSON: steps by the names of their activities, edges by number or "finish", "ask", "nowhere";
/// places in metres, with rotation vectors; borders [N/m].
[[nodiscard]] std::string to_json(const NamedTask& task);
/// Reads it back. Throws `std::runtime_error` for what is no task of this form, or one that `check` refuses;
/// at most 1 MB.
[[nodiscard]] NamedTask from_json(const std::string& json);
/// From a file.
[[nodiscard]] NamedTask load(const std::string& file);

}  // namespace teach
