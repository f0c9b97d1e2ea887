// Numbers in texts that machines read: the same characters in every locale.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <cstddef>
#include <limits>
#include <string>
#include <system_error>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

struct FormatArguments {
  std::va_list list;
};
template <class T, class... How>
[[nodiscard]] std::string digits_of(T value, How... how) {
  // The largest number with the most decimals that are written here: 309 and 100 digits.
  char text[std::numeric_limits<double>::max_exponent10 + 110];
  const auto end = std::to_chars(text, text + sizeof text, value, how...);
  return end.ec == std::errc() ? std::string(text, end.ptr) : std::string();
}

/// As `formatted`, of a list of arguments.
[[nodiscard]] SKINCTL_COLD inline std::string formatted_list(const char* format, FormatArguments& x) {
  constexpr int most_decimals = 100;
  std::string out;
  while (*format != '\0') {
    if (*format != '%') {
      out += *format++;
      continue;
    }
    bool left = false, zeros = false, plus = false;
    for (++format; *format == '-' || *format == '0' || *format == '+'; ++format)
      left |= *format == '-', zeros |= *format == '0', plus |= *format == '+';
    const auto number = [&] {
      int n = 0;
      if (*format == '*') return ++format, va_arg(x.list, int);
      for (; *format >= '0' && *format <= '9'; ++format) n = 10 * n + (*format - '0');
      return n;
    };
    const int width = number();
    int decimals = -1;
    if (*format == '.') ++format, decimals = std::min(number(), most_decimals);
    int longs = 0;
    for (; *format == 'l' || *format == 'z'; ++format) ++longs;
    const char kind = *format == '\0' ? '\0' : *format++;
    std::string text;
    switch (kind) {
      case 'd':
        text = longs == 0   ? digits_of(va_arg(x.list, int))
               : longs == 1 ? digits_of(va_arg(x.list, long))
                            : digits_of(va_arg(x.list, long long));
        break;
      case 'u':
      case 'x': {
        const int base = kind == 'x' ? 16 : 10;
        text = longs == 0   ? digits_of(va_arg(x.list, unsigned), base)
               : longs == 1 ? digits_of(va_arg(x.list, unsigned long), base)
                            : digits_of(va_arg(x.list, unsigned long long), base);
        break;
      }
      case 'f':
      case 'g':
      case 'e':
        text = digits_of(va_arg(x.list, double),
                         kind == 'f'   ? std::chars_format::fixed
                         : kind == 'g' ? std::chars_format::general
                                       : std::chars_format::scientific,
                         decimals < 0 ? 6 : decimals);
        break;
      case 'c':
        text = static_cast<char>(va_arg(x.list, int));
        break;
      case 's':
        text = va_arg(x.list, const char*);
        if (decimals >= 0) text.resize(std::min(text.size(), static_cast<std::size_t>(decimals)));
        break;
      default:
        text = kind == '\0' ? "" : std::string(1, kind);
        break;
    }
    if (plus && !text.starts_with('-')) text.insert(0, 1, '+');
    if (const auto wide = static_cast<std::size_t>(std::max(width, 0)); text.size() < wide) {
      const bool sign = text.starts_with('-') || text.starts_with('+');
      const std::size_t at = left ? text.size() : zeros && sign ? 1 : 0;
      text.insert(at, wide - text.size(), zeros && !left ? '0' : ' ');
    }
    out += text;
  }
  return out;
}

}  // namespace detail

/// What `std::printf` writes in the "C" locale, by `std::to_chars`: a point in every number and no marks between
/// thousands, whatever the locales of C and C++ are. For URScript, XML, JSON, SVG, CSV, C++: what machines read.
///
/// Conversions d, u, x, f, g, e, c, s and %%, with the flags -, 0 and +, width, precision (either as *) and the lengths l,
/// ll and z; compilers check the arguments. At most 100 decimals. Allocates.
[[nodiscard, gnu::format(printf, 1, 2)]] SKINCTL_COLD inline std::string formatted(const char* format, ...) {
  detail::FormatArguments x;
  va_start(x.list, format);
  std::string out = detail::formatted_list(format, x);
  va_end(x.list);
  return out;
}

SKINCTL_END_NAMESPACE
