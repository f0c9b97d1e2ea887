// Numbers into sentences.
#pragma once

#include <cstdio>
#include <string>

namespace calibrate_skin {

/// As printf; at most 599 characters.
template <class... X>
[[nodiscard]] std::string text(const char* format, X... x) {
  char buffer[600];
  std::snprintf(buffer, sizeof buffer, format, x...);
  return buffer;
}

}  // namespace calibrate_skin
