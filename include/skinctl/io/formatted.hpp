// SPDX-License-Identifier: BSD-3-Clause
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

/// One conversion of a format: its flags, width and kind.
struct Conversion {
  bool left = false, zeros = false, plus = false;
  int width = 0;
  int decimals = -1;  ///< number of decimals; -1: not given
  int longs = 0;
  char kind = '\0';

  /// Reads a conversion from behind its `%`, and moves `format` behind it.
  Conversion(const char*& format, FormatArguments& x) {
    constexpr int max_decimals = 100;
    for (; *format == '-' || *format == '0' || *format == '+'; ++format)
      left |= *format == '-', zeros |= *format == '0', plus |= *format == '+';
    const auto number = [&] {
      int n = 0;
      if (*format == '*') return ++format, va_arg(x.list, int);
      for (; *format >= '0' && *format <= '9'; ++format) n = 10 * n + (*format - '0');
      return n;
    };
    width = number();
    if (*format == '.') ++format, decimals = std::min(number(), max_decimals);
    for (; *format == 'l' || *format == 'z'; ++format) ++longs;
    if (*format != '\0') kind = *format++;
  }
  /// The next argument in characters, not padded.
  [[nodiscard]] std::string text(FormatArguments& x) const {
    using F = std::chars_format;
    const int base = kind == 'x' ? 16 : 10;
    const char* s = nullptr;
    switch (kind) {
      case 'd':
        return longs == 0   ? digits_of(va_arg(x.list, int))
               : longs == 1 ? digits_of(va_arg(x.list, long))
                            : digits_of(va_arg(x.list, long long));
      case 'u':
      case 'x':
        return longs == 0   ? digits_of(va_arg(x.list, unsigned), base)
               : longs == 1 ? digits_of(va_arg(x.list, unsigned long), base)
                            : digits_of(va_arg(x.list, unsigned long long), base);
      case 'f':
      case 'g':
      case 'e':
        return digits_of(va_arg(x.list, double),
                         kind == 'f'   ? F::fixed
                         : kind == 'g' ? F::general
                                       : F::scientific,
                         decimals < 0 ? 6 : decimals);
      case 'c':
        return std::string(1, static_cast<char>(va_arg(x.list, int)));
      case 's':
        s = va_arg(x.list, const char*);
        return decimals < 0 ? std::string(s) : std::string(s).substr(0, static_cast<std::size_t>(decimals));
      default:
        return kind == '\0' ? "" : std::string(1, kind);
    }
  }
  void pad(std::string& text) const {
    if (plus && !text.starts_with('-')) text.insert(0, 1, '+');
    const auto wide = static_cast<std::size_t>(std::max(width, 0));
    if (text.size() >= wide) return;
    const bool sign = text.starts_with('-') || text.starts_with('+');
    const std::size_t at = left ? text.size() : zeros && sign ? 1 : 0;
    text.insert(at, wide - text.size(), zeros && !left ? '0' : ' ');
  }
};

/// The text of `formatted`, for a list of arguments.
[[nodiscard]] SKINCTL_COLD inline std::string formatted_list(const char* format, FormatArguments& x) {
  std::string out;
  while (*format != '\0') {
    if (*format != '%') {
      out += *format++;
      continue;
    }
    const Conversion conversion(++format, x);
    std::string text = conversion.text(x);
    conversion.pad(text);
    out += text;
  }
  return out;
}

}  // namespace detail

/// The text that `std::printf` writes in the "C" locale, by `std::to_chars`: a point in every number and no
/// marks between thousands, whatever the locales of C and C++ are. For URScript, XML, JSON, SVG, CSV, C++:
/// what machines read.
///
/// Conversions d, u, x, f, g, e, c, s and %%, with the flags -, 0 and +, width, precision (either as *) and
/// the lengths l, ll and z; compilers check the arguments. At most 100 decimals. Allocates.
[[nodiscard, gnu::format(printf, 1, 2)]] SKINCTL_COLD inline std::string formatted(const char* format, ...) {
  detail::FormatArguments x;
  va_start(x.list, format);
  std::string out = detail::formatted_list(format, x);
  va_end(x.list);
  return out;
}

SKINCTL_END_NAMESPACE
