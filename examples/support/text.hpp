// Numbers in sentences.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <string>
#include <string_view>

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

/// Takes the number at the beginning of `rest`, behind blanks and a plus, as std::strtod does in the "C"
/// locale, and in every locale. False: there is none, or it is too large; nothing is taken then.
inline bool take_number(std::string_view& rest, double& x) {
  std::string_view at = rest.substr(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  if (at.starts_with('+') && !at.starts_with("+-")) at.remove_prefix(1);
  const auto [end, error] = std::from_chars(at.data(), at.data() + at.size(), x);
  if (error != std::errc{}) return false;
  rest = at.substr(static_cast<std::size_t>(end - at.data()));
  return true;
}

}  // namespace examples
