// SPDX-License-Identifier: BSD-3-Clause
// Errors of configuration, which throw, and contracts between the library's own functions, which stop debug
// builds.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An invalid configuration: a gain, a rate, a file. Thrown at construction, never in the loop. The text
/// names the quantity, its value and the allowed range.
class ConfigurationError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Called instead of `throw` in builds without exceptions; must not return. The default prints the text and
/// aborts. Set it before any configuration is built.
using ErrorHandler = void (*)(const char* what) noexcept;

namespace detail {
[[noreturn]] inline void abort_with(const char* what) noexcept {
  std::fputs(what, stderr);
  std::fputc('\n', stderr);
  std::abort();
}
inline ErrorHandler& error_handler() noexcept {
  static ErrorHandler handler = [](const char* what) noexcept { abort_with(what); };
  return handler;
}
}  // namespace detail

/// Replaces the handler of builds without exceptions; returns the old one.
inline ErrorHandler set_error_handler(ErrorHandler handler) noexcept {
  ErrorHandler old = detail::error_handler();
  detail::error_handler() = handler;
  return old;
}

/// Throws `ConfigurationError(what)`, or calls the handler where exceptions are off.
[[noreturn]] SKINCTL_COLD inline void refuse(const char* what) {
#if defined(__cpp_exceptions)
  throw ConfigurationError(what);
#else
  detail::error_handler()(what);
  detail::abort_with("skinctl: the error handler returned");
#endif
}
[[noreturn]] inline void refuse(const std::string& what) {
  refuse(what.c_str());
}

namespace detail {
[[noreturn]] SKINCTL_COLD inline void refuse_value(const char* name, double value, const char* range) {
  char text[512];
  std::snprintf(text, sizeof text, "skinctl: %s = %.9g, allowed: %s", name, value, range);
  refuse(text);
}
}  // namespace detail

/// Refuses `name = value` with the allowed range in words, e.g. `require(k > 0, "K_p", k, "> 0 1/s")`.
/// A NaN never satisfies a comparison, so it is refused as well.
SKINCTL_COLD inline void require(bool allowed, const char* name, double value, const char* range) {
  if (!allowed) detail::refuse_value(name, value, range);
}

SKINCTL_END_NAMESPACE

/// `SKINCTL_THROW("text")`: throws, or calls the handler in builds without exceptions.
#define SKINCTL_THROW(what) ::skinctl::refuse(what)

/// A contract between the library's own functions: checked in debug builds, free in release builds.
#if defined(NDEBUG)
#define SKINCTL_EXPECTS(condition, text) static_cast<void>(0)
#else
#define SKINCTL_EXPECTS(condition, text) \
  ((condition) ? static_cast<void>(0) : ::skinctl::detail::abort_with("skinctl: broken promise: " text))
#endif
