// The functions that the public headers offer, read from their text: what a check of "every function" counts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skinctl::testing {

/// A function that a user may call.
struct PublicFunction {
  std::string header;      ///< "skinctl/limits/tool_speed.hpp"
  std::string of;          ///< its class, empty for a free function: "EnergyTank"
  std::string name;        ///< that of the class for a constructor
  std::string parameters;  ///< as written, a blank between words
  bool throws = false;     ///< a constructor or a free function of configuration: it is not `noexcept`
  int line = 0;

  [[nodiscard]] std::string label() const { return of.empty() ? name : of + "::" + name; }
};

/// Those of `text`: free functions, and public members of classes that are not in a `detail` namespace. Left out: what
/// is deleted, defaulted or a deduction guide, operators and destructors.
[[nodiscard]] std::vector<PublicFunction> public_functions(const std::string& header,
                                                           const std::string& text);

/// Those of all headers below `include`, outside of `detail/` and of the folders in `without`.
[[nodiscard]] std::vector<PublicFunction> public_functions(const std::filesystem::path& include,
                                                           const std::vector<std::string>& without);

}  // namespace skinctl::testing
