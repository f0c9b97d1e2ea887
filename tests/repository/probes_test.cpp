// not sanitized: it reads the tree, and runs nothing of the library
//
// Promise: an optional member is asked for in the header of its protocol only, by a named concept; each
// goes through every wrapper and sum; one with a wrong signature does not compile
// Tried: every header; laws, touches. Also: `law/wrapped_law_test.cpp`, `tactile/touch_test.cpp`,
// `compile_fail/`

#include <doctest/doctest.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

// Headers of a protocol: what users write, and which members are asked for. Only they have concepts that name
// members.
const std::set<std::string> protocols = {
    "law/law.hpp",
    "law/detail/law_rows.hpp",
    "limits/limit.hpp",
    "sensing/sensor_kind.hpp",
    "tactile/touch.hpp",
    "tactile/detail/touch_rows.hpp",
    "tactile/detail/touch_fault.hpp",
    "core/detail/named_twice.hpp",
    "core/eigen_expression.hpp",
    "model/topology.hpp",
    "model/named_links.hpp",
    "model/model.hpp",
    "robot/robot_description.hpp",
    "robot/joint_groups.hpp",
    "resolver/resolver_of.hpp",
    "cycle/input.hpp",
    "cycle/scene_parts.hpp",
    "cycle/detail/starts_with.hpp",
    "hardware/robot.hpp",
    "hardware/gripper.hpp",
    "semantics/activity.hpp",
    "recording/mcap.hpp",
    "calibration/least_squares.hpp",
};

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}
std::size_t end_of(const std::string& text, std::size_t at, char open, char close) {
  for (int depth = 0; at < text.size(); ++at) {
    if (text[at] == open) ++depth;
    if (text[at] == close && --depth == 0) return at;
  }
  return text.size() - 1;
}
std::size_t behind_space(const std::string& text, std::size_t at) {
  while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0) ++at;
  return at;
}

// The requires-expressions of a header that ask for a member, each with what stands before it in its
// statement.
std::vector<std::string> probes(std::string text, bool in_concepts) {
  text = std::regex_replace(text, std::regex("//[^\n]*"), "");
  text = std::regex_replace(text, std::regex("\"(\\\\.|[^\"\\\\\n])*\""), "\"\"");
  static const std::regex parameters("\\((const |typename |[A-Z][\\w:<>, ]*& ?\\w+ *[,)])[^|]*");
  static const std::regex member("\\w\\.\\w|\\w\\.template |[A-Z]\\w*::\\w");
  std::vector<std::string> found;
  const std::string word = "requires";
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    if (at > 0 && is_word(text[at - 1])) continue;
    std::size_t body = behind_space(text, at + word.size());
    if (body >= text.size()) break;
    if (text[body] == '(') {
      const std::size_t last = end_of(text, body, '(', ')');
      if (!std::regex_match(text.substr(body, last + 1 - body), parameters)) continue;
      body = behind_space(text, last + 1);
    }
    if (body >= text.size() || text[body] != '{') continue;
    const std::size_t last = end_of(text, body, '{', '}');
    const std::size_t statement = text.find_last_of(";{}", at);
    const std::string head = text.substr(statement + 1, at - statement - 1);
    const std::string asked = text.substr(at, last + 1 - at);
    const bool in_concept = head.find("concept ") != std::string::npos;
    if (std::regex_search(asked, member) && !(in_concept && in_concepts))
      found.push_back(asked.substr(0, 120));
    at = last;
  }
  return found;
}

}  // namespace

TEST_CASE("Probes: only the header of a protocol asks whether there is a member, by a named concept") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const fs::path root = fs::path(source != nullptr ? source : ".") / "include" / "skinctl";
  std::size_t headers = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".hpp") continue;
    ++headers;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string name = fs::relative(entry.path(), root).generic_string();
    for (const auto& probe : probes(text, protocols.contains(name))) FAIL_CHECK(name << ": " << probe);
  }
  CHECK(headers > 100);
}

TEST_CASE("Probes: of members are found, clauses and other requirements are none") {
  CHECK(probes("if constexpr (requires { law.now(m); }) law.now(m);", true).size() == 1);
  CHECK(probes("template <class L>\n  requires requires { typename L::Goal; }\nstruct A;", true).size() == 1);
  CHECK(probes("bool x = requires(const L& law) { law.status(); };", true).size() == 1);
  CHECK(probes("concept X = requires(const L& law) { law.status(); };", true).empty());
  CHECK(probes("concept X = requires(const L& law) { law.status(); };", false).size() == 1);
  CHECK(probes("T f() const requires(N > 0) { return a.b; }", true).empty());
  CHECK(probes("T f() const requires(First::x || Second::y) { return a.b; }", true).empty());
  CHECK(probes("requires requires(const V& v) { begin(v) == end(v); }", true).empty());
  CHECK(probes("// requires { law.now(m); }", false).empty());
}
