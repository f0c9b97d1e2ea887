// not sanitized: it reads the tree, and runs nothing of the library
#include "tests/support/fault_table.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "skinctl/guard/faults.hpp"

using namespace skinctl;
using namespace skinctl::testing;
namespace fs = std::filesystem;

namespace {
fs::path top() {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  return source != nullptr ? source : ".";
}
std::string contents(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}
}  // namespace

TEST_CASE("Faults: the rows are named as the enumerators, in their order") {
  const auto reasons = reasons_in(contents(top() / "include/skinctl/core/status.hpp"));
  REQUIRE(reasons.size() == faults.size());
  for (std::size_t i = 0; i < faults.size(); ++i) CHECK(faults[i].name == reasons[i]);
}

TEST_CASE("Faults: each reason is set by the library") {
  const auto by = producers(top() / "include");
  for (const Fault& f : faults) {
    CAPTURE(f.name);
    CHECK(by.contains(f.name));
  }
}

TEST_CASE("Faults: the page shows the table as the library has it") {
  const std::string table = fault_table();
  CAPTURE(table);
  CHECK(fault_block(contents(top() / "include/skinctl/README.md")) == table);
}

TEST_CASE("Faults: what is asked for, taken out or written about is not set") {
  CHECK(reasons_set_by("if (s.has(Reason::blocked)) return; // Reason::opposed\n"
                       "s = s & ~Status(Reason::singular).bits();  s & Status(Reason::jerk_exceeded);")
            .empty());
  CHECK(reasons_set_by("status |= Reason::blocked;\n return {m, Reason::goal_refused}; // has(Reason::x)\n"
                       "x ? Status(Reason::slowed) : Status{};") ==
        std::vector<std::string>{"blocked", "goal_refused", "slowed"});
}

TEST_CASE("Faults: a page's block is what stands between its two marks") {
  CHECK(fault_block("a\n<!-- faults:begin -->\n| x |\n<!-- faults:end -->\nb\n") == "| x |\n");
  CHECK(fault_block("a\n<!-- faults:begin -->\n| x |\n").empty());
  CHECK(fault_block("| x |\n").empty());
  CHECK(reasons_in("enum class Reason : int {\n  a,  // b\n  c,\n  count\n};") ==
        std::vector<std::string>{"a", "c"});
}
