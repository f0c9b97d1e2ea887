// What the controller tells its primary clients beside the state: texts, events and errors.
#pragma once

#include <cstdint>
#include <string>

namespace simulated_ur5 {

/// Codes of protective stops: by a program's protective_stop() (C209A0, a warning); the check of a path, for
/// all others here.
inline constexpr std::int32_t by_program_code = 209, path_code = 204;

struct Notice {
  enum class Kind {
    text,         ///< textmsg
    key,          ///< an event: `title` PROGRAM_XXX_STARTED or PROGRAM_XXX_STOPPED, `text` the program
    violation,    ///< error code `code`, argument `argument`; a warning if `warning`
    safety_mode,  ///< it changed to `argument`
    exception,    ///< a program's error at `line`, `column`
    popup
  };
  Kind kind = Kind::text;
  std::string text, title{};
  std::int32_t line = 0, column = 0;
  std::int32_t code = 0, argument = 0;
  bool warning = false, error = false, blocking = false;
};

}  // namespace simulated_ur5
