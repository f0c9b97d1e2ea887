// not sanitized: it reads the tree, and runs nothing of the library
//
// Promise: a body stands at its declaration: no include behind a namespace, no macro for the head of a
// template
// Tried: every header

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <istream>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

// Lines by which the body of a function would stand elsewhere than at its declaration: an include behind the
// namespace, and a macro that stands for the head of a template.
std::vector<std::string> detours(std::istream& header) {
  std::vector<std::string> found;
  bool behind = false;
  for (std::string line; std::getline(header, line);) {
    behind = behind || line.starts_with("SKINCTL_END_NAMESPACE");
    const bool head = line.starts_with("#define") && line.find(" template") != std::string::npos;
    if (head || (behind && line.starts_with("#include"))) found.push_back(line);
  }
  return found;
}

}  // namespace

TEST_CASE("Routes: bodies stand at their declarations, in every header") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  std::size_t headers = 0;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(source != nullptr ? source : ".") / "include")) {
    if (entry.path().extension() != ".hpp") continue;
    ++headers;
    std::ifstream header(entry.path());
    for (const auto& line : detours(header)) FAIL_CHECK(entry.path().string() << ": " << line);
  }
  CHECK(headers > 100);
}

TEST_CASE("Routes: a tail include and the head of a template in a macro are found") {
  std::istringstream header(
      "#include \"a.hpp\"\nSKINCTL_BEGIN_NAMESPACE\n#define HEAD template <class T>\n#define TEXT(x) #x\n"
      "SKINCTL_END_NAMESPACE\n\n#include \"b.hpp\"\n");
  CHECK(detours(header) == std::vector<std::string>{"#define HEAD template <class T>", "#include \"b.hpp\""});
}
