// not sanitized: it reads the tree, and runs nothing of the library
//
// Promise: the pages say what the code does
// Tried: code blocks of the README, the tutorial and the how-tos block by block, every link, the table of
// faults. Also: `pages_test.cpp`, `fault_table_test.cpp`), `ctest -R repository/tutorial`, `ctest -R
// repository/how_to`

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/readme_blocks.hpp"

using namespace skinctl::testing;
namespace fs = std::filesystem;

namespace {
std::string contents(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}
}  // namespace

TEST_CASE("README: every block of C++ is a marked region of a compiled example") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const fs::path top = source != nullptr ? source : ".";
  std::set<std::string> regions;
  for (const auto& entry : fs::recursive_directory_iterator(top / "examples")) {
    const auto extension = entry.path().extension();
    if (extension != ".cpp" && extension != ".hpp") continue;
    for (const auto& [name, text] : marked_regions(contents(entry.path()))) regions.insert(text);
  }
  for (const auto& block : cpp_blocks(contents(top / "README.md"))) {
    CAPTURE(block);
    CHECK(regions.contains(block));
  }
}

TEST_CASE("README: blocks are found between their fences, other languages are not ours") {
  const auto blocks =
      cpp_blocks("text\n```cpp\nint a;\n\nint b;\n```\n```sh\nls\n```\n```cpp\nint c;\n```\n");
  REQUIRE(blocks.size() == 2);
  CHECK(blocks[0] == "int a;\n\nint b;\n");
  CHECK(blocks[1] == "int c;\n");
}

TEST_CASE("README: regions lose the indentation that they share, and nothing else") {
  const auto regions = marked_regions(
      "int main() {\n  // [readme:loop]\n  for (;;) {\n    // [readme:inner]\n    step();\n    // "
      "[/readme:inner]\n\n  }\n"
      "  // [/readme:loop]\n}\n");
  CHECK(regions.at("loop") == "for (;;) {\n  step();\n\n}\n");
  CHECK(regions.at("inner") == "step();\n");
}

TEST_CASE("README: a region that does not end, or never began, is refused") {
  CHECK_THROWS_WITH(static_cast<void>(marked_regions("// [readme:a]\nint a;\n")),
                    "readme region without an end: a");
  CHECK_THROWS_WITH(static_cast<void>(marked_regions("int a;\n// [/readme:a]\n")),
                    "readme region ends that never began: a");
}

TEST_CASE("Pages: a program has the heading, the line and the printed text that stand around it") {
  const auto blocks = shown_programs(
      "# Page\n```cpp\n# not a heading\n```\n## Push it\n```sh\nls\n```\n```cpp\nint a;\n```\nIt "
      "prints\n```text\n1\n2\n```\n");
  REQUIRE(blocks.size() == 2);
  CHECK(blocks[0].heading == "Page");
  CHECK(blocks[0].line == 3);
  CHECK(blocks[0].printed.empty());
  CHECK(blocks[1].heading == "Push it");
  CHECK(blocks[1].line == 10);
  CHECK(blocks[1].code == "int a;\n");
  CHECK(blocks[1].printed == "1\n2\n");
  CHECK_THROWS_WITH(static_cast<void>(shown_programs("```text\n1\n```\n")),
                    "a block of text without a program: line 1");
}
