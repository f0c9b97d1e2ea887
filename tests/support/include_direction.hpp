// Which folder of include/skinctl may include which: the table, and the check of `#include` lines against it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skinctl::testing {

/// A folder and those it may use directly; what these may use it may use as well, and everyone may use core.
struct Folder {
  std::string name;
  std::vector<std::string> may_use;
};

/// The house, from the bottom up.
[[nodiscard]] const std::vector<Folder>& folders();

/// Everything wrong with the headers below `include` (which holds skinctl/), one sentence each: an include
/// that points down or to a missing header, a folder that is not in the table, a skinctl.hpp that holds more
/// than includes, misses a public header, or reaches for what it must leave to the user (io, calibration,
/// semantics).
[[nodiscard]] std::vector<std::string> include_errors(const std::filesystem::path& include);

}  // namespace skinctl::testing
