#include "skinctl/semantics/dot.hpp"

#include <doctest/doctest.h>

#include <cstring>
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
/// Whether every tag is closed, in the right order, and every attribute is quoted.
bool well_formed(const std::string& xml) {
  std::string open[64];
  std::size_t depth = 0;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] != '<') continue;
    const auto end = xml.find('>', i);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(i + 1, end - i - 1);
    if (count(tag, "\"") % 2 != 0 || tag.find('<') != std::string::npos) return false;
    if (tag[0] == '?' || tag.back() == '/') continue;
    if (tag[0] == '/') {
      if (depth == 0 || open[--depth] != tag.substr(1)) return false;
    } else {
      open[depth++] = tag.substr(0, tag.find(' '));
    }
  }
  return depth == 0;
}
}  // namespace

TEST_CASE("to_dot: every step, and every edge that there is") {
  const auto dot = to_dot(packing_oranges, words);
  CHECK(dot.find("s5 [label=\"put orange & \\\"co\\\", box\"]") != std::string::npos);
  CHECK(count(dot, "[style=dashed, label=no]") == 2);
  CHECK(count(dot, " -> ") == 9 + 9 + 2);
  CHECK(count(dot, "ask") == 0);
  CHECK(dot.find("s0 -> done [style=dashed") != std::string::npos);
}

TEST_CASE("to_behaviour_tree: a loop over the steps, each an action with its ports") {
  const auto xml = to_behaviour_tree(packing_oranges, words);
  CHECK(well_formed(xml));
  CHECK(count(xml, "<IfThenElse _skipIf=\"step != ") == 9);
  CHECK(xml.find("step := answer ? 5 : 7") != std::string::npos);
  CHECK(xml.find("role=\"orange &amp; &quot;co&quot;\" place=\"bin\"") != std::string::npos);
  CHECK(count(xml, "<Action ID=\"put\"") == 2 + 1);  // two steps, one model
  CHECK(count(xml, "BTCPP_format=\"4\"") == 1);
}

TEST_CASE("to_svg: one box a step, one line an edge") {
  constexpr auto asks = task("ask <once>", {}, step_of<activity::Look>({.failed = ask_person}));
  CHECK(well_formed(to_svg(packing_oranges, words)));
  CHECK(well_formed(to_svg(asks)));
  CHECK(count(to_svg(packing_oranges, words), "<rect") == 9 + 2);
  CHECK(count(to_svg(packing_oranges, words), "marker-end") == 20);
  CHECK(count(to_svg(asks), "ask a person") == 1);
  CHECK(to_dot(asks).find("s0 -> ask") != std::string::npos);
}
