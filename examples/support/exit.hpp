// Exit codes of the programs that move a device, with words.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace examples::job {

/// How a job ended: the exit code of its program. A job that ended otherwise than it should is never 0.
enum class Exit : int {
  fine = 0,
  lost = 1,
  refused = 2,
  broken = 3,
  blind = 4,
  halted = 5,
  not_following = 6,
  implausible = 7,
  interrupted = 130
};

struct ExitRow {
  Exit exit;
  const char* name;   ///< as the enumerator
  const char* words;  ///< for logs and `--help`
};
inline constexpr std::array<ExitRow, 9> exits{{
    {Exit::fine, "fine", "ended as asked"},
    {Exit::lost, "lost", "a device went away, cannot be reached, or talked nonsense"},
    {Exit::refused, "refused", "an option, file or number is wrong; nothing has moved"},
    {Exit::broken, "broken",
     "a promise was broken: a command beyond its limits, an allocation in the loop, a replay that differs"},
    {Exit::blind, "blind", "too little of skin or sensor reports"},
    {Exit::halted, "halted",
     "the device was halted: paused or stopped by its operator, or by its own safety functions"},
    {Exit::not_following, "not_following",
     "the joints do not do what they are told, or come later than declared"},
    {Exit::implausible, "implausible",
     "states that cannot be: not a number, or a clock that stands or goes back"},
    {Exit::interrupted, "interrupted", "SIGINT, SIGTERM or SIGHUP"},
}};

[[nodiscard]] constexpr const ExitRow& row(Exit exit) noexcept {
  for (const ExitRow& r : exits)
    if (r.exit == exit) return r;
  return exits[1];
}
[[nodiscard]] constexpr const char* words(Exit exit) noexcept {
  return row(exit).words;
}
[[nodiscard]] constexpr int code(Exit exit) noexcept {
  return static_cast<int>(exit);
}
/// The table, for the end of `--help`.
[[nodiscard]] inline std::string exit_help() {
  std::string out = "Exit codes:\n";
  for (const ExitRow& r : exits) {
    char line[160];
    std::snprintf(line, sizeof line, "  %3d  %s\n", code(r.exit), r.words);
    out += line;
  }
  return out;
}

}  // namespace examples::job
