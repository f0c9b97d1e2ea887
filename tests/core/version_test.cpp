#include "skinctl/core/version.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <string>

TEST_CASE("Version: the header's is that of the build and of the package") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  REQUIRE(source != nullptr);
  std::ifstream file(std::string(source) + "/CMakeLists.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::smatch found;
  REQUIRE(std::regex_search(text, found,
                            std::regex("project\\(skinctl\\s+VERSION ([0-9]+)\\.([0-9]+)\\.([0-9]+)\\s")));
  CHECK(std::stoi(found[1]) == SKINCTL_VERSION_MAJOR);
  CHECK(std::stoi(found[2]) == SKINCTL_VERSION_MINOR);
  CHECK(std::stoi(found[3]) == SKINCTL_VERSION_PATCH);
  CHECK(found[1].str() + "." + found[2].str() + "." + found[3].str() == SKINCTL_VERSION);
}
