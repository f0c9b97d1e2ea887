// Numbers in sentences.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace examples {

/// What printf would print.
[[nodiscard, gnu::format(printf, 1, 2)]] inline std::string text(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, format, values);
  va_end(values);
  std::string out(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(out.data(), out.size() + 1, format, again);
  va_end(again);
  return out;
}

}  // namespace examples
