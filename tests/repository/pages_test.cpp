// not sanitized: it reads the tree, and runs nothing of the library
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "tests/support/include_direction.hpp"
#include "tests/support/page_links.hpp"

using namespace skinctl::testing;
namespace fs = std::filesystem;

namespace {
fs::path source() {
  const char* folder = std::getenv("SKINCTL_SOURCE_DIR");
  return folder != nullptr ? folder : ".";
}
void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}
}  // namespace

TEST_CASE("Pages: every link between them leads to a file and to a heading") {
  for (const auto& error : link_errors(source())) FAIL_CHECK(error);
}

TEST_CASE("Pages: the README can be read in two minutes") {
  CHECK(fs::file_size(source() / "README.md") <= 7000);
  for (const char* page : {"include/skinctl", "examples", "tests", "bench"}) {
    CAPTURE(page);
    CHECK(fs::exists(source() / page / "README.md"));
  }
}

/// How many tests `text` names between grave accents; each has to be there.
int named_tests(std::istream&& text) {
  int named = 0;
  for (std::string word; std::getline(text, word, '`');) {
    const bool path = word.size() > 4 && word.ends_with(".cpp") && word.find_first_of(" \n*") == word.npos;
    if (!path) continue;
    CAPTURE(word);
    CHECK((fs::exists(source() / "tests" / word) || fs::exists(source() / word) ||
           fs::exists(source() / "tests/repository" / word)));
    ++named;
  }
  return named;
}

TEST_CASE("Pages: every test that tests/README.md and the tests name is there") {
  CHECK(named_tests(std::ifstream(source() / "tests/README.md")) > 10);
  int named = 0;
  for (const auto& entry : fs::recursive_directory_iterator(source() / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    CAPTURE(entry.path());
    std::ifstream file(entry.path());
    std::string comment;
    for (std::string line; std::getline(file, line) && line.starts_with("//");) comment += line.substr(2);
    named += named_tests(std::istringstream(comment));
  }
  CHECK(named > 50);
}

TEST_CASE("Pages: the house is the table against which includes are checked") {
  std::map<std::string, std::string> rows;  // folder, what it may use
  std::ifstream page(source() / "include/skinctl/README.md");
  for (std::string line; std::getline(page, line);) {
    const auto end = line.find("/` | ");
    const auto last = line.rfind(" | ");
    if (line.rfind("| `", 0) == 0 && end != line.npos && line.ends_with(" |"))
      rows[line.substr(3, end - 3)] = line.substr(last + 3, line.size() - last - 5);
  }
  std::size_t shown = 0;
  for (const auto& folder : folders()) {
    std::string used;
    for (const auto& other : folder.may_use) used += (used.empty() ? "" : ", ") + other;
    if (folder.name == "testing") used = "all";
    CAPTURE(folder.name);
    CHECK(rows[folder.name] == (used.empty() ? "-" : used));
    ++shown;
  }
  CHECK(rows.size() == shown);
}

TEST_CASE("Pages: links are found outside of code, and headings have anchors") {
  const auto targets = link_targets(
      "[a](x.md) and ![b](y.svg)\n```\n[c](z.md)\n```\n[`d`](w.md) `[e](v.md)`\n    [f](u.md)\n");
  CHECK(targets == std::vector<std::string>{"x.md", "y.svg", "w.md"});
  CHECK(heading_anchors("# One two\ntext\n## 3 Your robot, `x`!\n#no\n") ==
        std::vector<std::string>{"one-two", "3-your-robot-x"});
}

TEST_CASE("Pages: a link that leads nowhere is named") {
  const fs::path top = fs::temp_directory_path() / ("skinctl_pages_" + std::to_string(std::rand()));
  write(top / "README.md",
        "# Top\n[a](a/README.md) [b](a/README.md#here) [c](#top) [d](https://nowhere.invalid/x)\n"
        "[e](missing.svg) [f](a/README.md#nowhere) [g](../outside.md)\n");
  write(top / "a/README.md", "## Here\n[up](../README.md) [folder](../a)\n");
  write(top / "build/README.md", "[not ours](gone.md)\n");
  write(top / ".hidden/README.md", "[not ours](gone.md)\n");
  write(top / ".github/CONTRIBUTING.md", "[gone](gone.md)\n");
  const auto errors = link_errors(top);
  fs::remove_all(top);
  REQUIRE(errors.size() == 4);
  CHECK(errors[0] == ".github/CONTRIBUTING.md: link to gone.md: there is no such file");
  CHECK(errors[1] == "README.md: link to missing.svg: there is no such file");
  CHECK(errors[2] == "README.md: link to a/README.md#nowhere: that page has no such heading");
  CHECK(errors[3] == "README.md: link to ../outside.md: there is no such file");
}
