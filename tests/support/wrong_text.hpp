// For tests of parsers: texts that are wrong in one place, and what is said of them.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "skinctl/core/contract.hpp"

namespace skinctl::testing {

/// What the `ConfigurationError` that `f()` throws says; empty: it throws none.
template <class F>
std::string complaint_of(F&& f) {
  try {
    static_cast<void>(f());
  } catch (const ConfigurationError& e) {
    return e.what();
  }
  return "";
}
/// `text` with the first `from` replaced by `to`; a test whose text has no `from` fails.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace skinctl::testing
