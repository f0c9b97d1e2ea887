// SPDX-License-Identifier: BSD-3-Clause
// Numbers from text in any locale, also where the standard library reads no floating-point ones (libc++
// before 20).
#pragma once

#include <charconv>
#include <version>

#include "skinctl/core/config.hpp"

#if !defined(_WIN32)
#include <locale.h>
#include <stdlib.h>

#include <cmath>
#include <string>
#if defined(__APPLE__)
#include <xlocale.h>
#endif
#endif

SKINCTL_BEGIN_NAMESPACE
namespace detail {

#if !defined(_WIN32)
/// As `std::from_chars`, by the C library.
inline std::from_chars_result from_chars_by_strtod(const char* first, const char* last, double& x) {
  static const locale_t classic = newlocale(LC_ALL_MASK, "C", nullptr);
  // What strtod takes besides: blanks and a plus before the number, hexadecimal digits.
  const char* number = first != last && *first == '-' ? first + 1 : first;
  const bool begins =
      number != last && ((*number >= '0' && *number <= '9') || *number == '.' || *number == 'i' ||
                         *number == 'I' || *number == 'n' || *number == 'N');
  std::string copy(first, begins ? last : first);
  if (const auto hexadecimal = copy.find_first_of("xX"); hexadecimal != copy.npos) copy.resize(hexadecimal);
  char* end = nullptr;
  const double value = strtod_l(copy.c_str(), &end, classic);
  if (end == copy.c_str()) return {first, std::errc::invalid_argument};
  const char* behind = first + (end - copy.c_str());
  const bool overflows = std::isinf(value) && *number != 'i' && *number != 'I';
  const auto digit = copy.find_first_of("123456789");
  const bool vanishes = value == 0 && digit < copy.find_first_of("eE") && copy.c_str() + digit < end;
  if (overflows || vanishes) return {behind, std::errc::result_out_of_range};
  x = value;
  return {behind, std::errc()};
}
#endif

#if defined(__cpp_lib_to_chars) || !defined(_LIBCPP_VERSION)
using std::from_chars;
#else
template <class T>
std::from_chars_result from_chars(const char* first, const char* last, T& x) {
  if constexpr (std::is_integral_v<T>) {
    return std::from_chars(first, last, x);
  } else {
    return from_chars_by_strtod(first, last, x);
  }
}
#endif

}  // namespace detail
SKINCTL_END_NAMESPACE
