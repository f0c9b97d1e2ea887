// The code that the README shows, and the marked regions of examples that it must equal.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace skinctl::testing {

/// The contents of the fenced ```cpp blocks of a Markdown text, in order.
[[nodiscard]] std::vector<std::string> cpp_blocks(const std::string& markdown);

/// Name and text of the regions of a source between `// [readme:NAME]` and `// [/readme:NAME]`, without the
/// indentation that all their lines share. Throws `std::runtime_error` if a region has no end.
[[nodiscard]] std::map<std::string, std::string> marked_regions(const std::string& source);

}  // namespace skinctl::testing
