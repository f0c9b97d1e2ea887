// not sanitized: it reads the tree, and runs nothing of the library
//
// Promise: a header includes only folders above its own
// Tried: every `#include`

#include "tests/support/include_direction.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

using namespace skinctl::testing;
namespace fs = std::filesystem;

namespace {

// A tree of headers below the system's temporary folder, gone with the object.
class Tree {
 public:
  Tree() {
    std::string pattern = (fs::temp_directory_path() / "skinctl-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    root_ = pattern;
    fs::create_directories(root_ / "skinctl");
  }
  ~Tree() { fs::remove_all(root_); }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  void write(const std::string& header, const std::string& text) const {
    fs::create_directories((root_ / header).parent_path());
    std::ofstream(root_ / header) << text;
  }
  [[nodiscard]] std::vector<std::string> errors() const { return include_errors(root_); }

 private:
  fs::path root_;
};

}  // namespace

TEST_CASE("Includes: skinctl's own point up the table only") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const auto errors = include_errors(fs::path(source != nullptr ? source : ".") / "include");
  for (const auto& error : errors) FAIL_CHECK(error);
  CHECK(errors.empty());
}

TEST_CASE("Includes: every row of the table uses rows above it only") {
  std::vector<std::string> above;
  for (const auto& folder : folders()) {
    for (const auto& used : folder.may_use) {
      CAPTURE(folder.name);
      CAPTURE(used);
      CHECK(std::find(above.begin(), above.end(), used) != above.end());
    }
    above.push_back(folder.name);
  }
}

TEST_CASE("Includes: a good tree passes, over several steps and with details") {
  const Tree tree;
  tree.write("skinctl/core/real.hpp", "#pragma once\n");
  tree.write("skinctl/math/detail/table.hpp", "#include <skinctl/core/real.hpp>\n");
  tree.write("skinctl/math/sincos.hpp", "#include \"skinctl/math/detail/table.hpp\"\n");
  tree.write("skinctl/dynamics/gravity.hpp",
             "#  include \"skinctl/math/sincos.hpp\"\n#include <Eigen/Core>\n");
  tree.write("skinctl/fusion/sum.hpp", "#include \"skinctl/core/real.hpp\"\n");
  tree.write("skinctl/io/urdf.hpp", "#include \"skinctl/dynamics/gravity.hpp\"\n");
  tree.write("skinctl/skinctl.hpp",
             "// All.\n#pragma once\n\n#include \"skinctl/core/real.hpp\"\n#include "
             "\"skinctl/dynamics/gravity.hpp\"\n"
             "#include \"skinctl/fusion/sum.hpp\"\n#include \"skinctl/math/sincos.hpp\"\n");
  for (const auto& error : tree.errors()) FAIL_CHECK(error);
}

TEST_CASE("Includes: what points down, sideways or nowhere is named") {
  const Tree tree;
  tree.write("skinctl/core/real.hpp", "#include \"skinctl/math/sincos.hpp\"\n");
  tree.write("skinctl/math/sincos.hpp", "#include \"skinctl/core/missing.hpp\"\n");
  tree.write("skinctl/frames/detail/axis.hpp", "#include <skinctl/dynamics/gravity.hpp>\n");
  tree.write("skinctl/dynamics/gravity.hpp", "#include \"skinctl/sensing/cell.hpp\"\n");
  tree.write("skinctl/sensing/cell.hpp", "");
  tree.write("skinctl/fusion/sum.hpp", "#include \"skinctl/sensing/cell.hpp\"\n");
  tree.write("skinctl/misc/other.hpp", "");
  tree.write("skinctl/io/urdf.hpp", "");
  tree.write("skinctl/skinctl.hpp",
             "#pragma once\nint x;\n#include \"skinctl/io/urdf.hpp\"\n"
             "#include \"skinctl/core/real.hpp\"\n#include \"skinctl/math/sincos.hpp\"\n"
             "#include \"skinctl/dynamics/gravity.hpp\"\n#include \"skinctl/fusion/sum.hpp\"\n"
             "#include \"skinctl/misc/other.hpp\"\n");
  const std::vector<std::string> expected = {
      "skinctl/core/real.hpp includes skinctl/math/sincos.hpp: core/ may not use math/",
      "skinctl/dynamics/gravity.hpp includes skinctl/sensing/cell.hpp: dynamics/ may not use sensing/",
      "skinctl/frames/detail/axis.hpp includes skinctl/dynamics/gravity.hpp: frames/ may not use dynamics/",
      "skinctl/fusion/sum.hpp includes skinctl/sensing/cell.hpp: fusion/ may not use sensing/",
      "skinctl/math/sincos.hpp includes skinctl/core/missing.hpp, which does not exist",
      "skinctl/misc/other.hpp: its folder is not in the table",
      "skinctl/skinctl.hpp: holds more than includes: int x;",
      "skinctl/skinctl.hpp must not include skinctl/io/urdf.hpp",
      "skinctl/skinctl.hpp lacks skinctl/sensing/cell.hpp",
  };
  CHECK(tree.errors() == expected);
}
