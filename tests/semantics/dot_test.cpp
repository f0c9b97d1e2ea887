#include "skinctl/semantics/dot.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/semantics/packing_task.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
const char* const roles[] = {"", "orange & \"co\""};
const char* const places[] = {"box", "bin"};
const TaskWords words{roles, places};

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}
}  // namespace

TEST_CASE("to_dot: every step, and every edge that there is") {
  const auto dot = to_dot(packing_oranges, words);
  CHECK(dot.find("s5 [label=\"put orange & \\\"co\\\", box\"]") != std::string::npos);
  CHECK(count(dot, "[style=dashed, label=no]") == 2);
  CHECK(count(dot, " -> ") == 9 + 9 + 2);
  CHECK(count(dot, "ask") == 0);
  CHECK(dot.find("s0 -> done [style=dashed") != std::string::npos);
  constexpr auto asks = task("ask <once>", {}, step_of<activity::Look>({.failed = ask_person}));
  CHECK(to_dot(asks).find("s0 -> ask") != std::string::npos);
}
