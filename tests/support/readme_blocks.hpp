// The code that the README shows, and the marked regions of examples that it must equal.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace skinctl::testing {

/// The contents of the fenced ```cpp blocks of a Markdown text, in order.
[[nodiscard]] std::vector<std::string> cpp_blocks(const std::string& markdown);

/// A program on a page, and what it prints: a block of `cpp` and the block of `text` behind it.
struct ShownBlock {
  std::string heading;   ///< the last one before the block
  std::size_t line = 0;  ///< of the page, from 1, of the first line of the code
  std::string code, printed;
};

/// The blocks of `cpp` of a Markdown text, in order. A block of `text` belongs to the block of `cpp` before
/// it; throws `std::runtime_error` where there is none, or where it has one already.
[[nodiscard]] std::vector<ShownBlock> shown_programs(const std::string& markdown);

/// Name and text of the regions of a source between `// [readme:NAME]` and `// [/readme:NAME]`, without the
/// indentation that all their lines share. Throws `std::runtime_error` if a region has no end.
[[nodiscard]] std::map<std::string, std::string> marked_regions(const std::string& source);

}  // namespace skinctl::testing
