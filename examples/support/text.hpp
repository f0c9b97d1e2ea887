// Numbers in sentences.
#pragma once

#include <cstdarg>
#include <string>

#include "skinctl/io/formatted.hpp"

namespace examples {

/// As `skinctl::formatted`.
[[nodiscard, gnu::format(printf, 1, 2)]] inline std::string text(const char* format, ...) {
  skinctl::detail::FormatArguments values;
  va_start(values.list, format);
  std::string out = skinctl::detail::formatted_list(format, values);
  va_end(values.list);
  return out;
}

}  // namespace examples
