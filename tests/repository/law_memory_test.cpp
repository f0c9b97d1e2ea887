// not sanitized: it reads the tree, and runs nothing of the library
// No law reads or writes the memory of another: what others may know of it are members of the law.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

/// Each place where a header reaches through a member of the type `typename L::Memory`, L a law, into what it
/// holds: `m.blend.elapsed`, `memory.law.plan`.
std::vector<std::string> reaches(const std::string& name, const std::string& text) {
  static const std::regex member(R"((?:typename\s+)?([A-Za-z_]\w*)::Memory\s+(\w+)\s*(?:=[^;]*)?;)");
  static const std::set<std::string> no_laws{"Space",
                                             "OppositionDetector",
                                             "ContactDetector",
                                             "Keeper",
                                             "Watchman",
                                             "Skin",
                                             "Overseer",
                                             "Resolver",
                                             "Sign",
                                             "Health",
                                             "S",
                                             "Range"};
  std::set<std::string> names;
  for (std::sregex_iterator i(text.begin(), text.end(), member), end; i != end; ++i)
    if (no_laws.count((*i)[1]) == 0) names.insert((*i)[2]);
  std::vector<std::string> found;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = line.substr(0, line.find("//"));
    for (const auto& member_name : names) {
      const std::regex through(R"(\b(m|memory|next|before|there|begun)\.)" + member_name + R"(\.\w)");
      if (std::regex_search(line, through)) found.push_back(name + ":" + std::to_string(number) + ":" + line);
    }
  }
  return found;
}

/// A header, and what it holds of its parts in `detail/`, as one text.
std::map<std::string, std::string> headers(const fs::path& include) {
  std::map<std::string, std::string> texts;
  static const std::regex part("#include \"(skinctl/[a-z_]+/detail/[a-z_0-9]+\\.hpp)\"");
  const auto read = [](const fs::path& path) {
    std::ostringstream out;
    out << std::ifstream(path).rdbuf();
    return out.str();
  };
  for (const auto& entry : fs::recursive_directory_iterator(include)) {
    if (entry.path().extension() != ".hpp") continue;
    std::string text = read(entry.path());
    const std::string own = text;
    for (std::sregex_iterator i(own.begin(), own.end(), part), end; i != end; ++i)
      text += read(include / (*i)[1].str());
    texts[fs::relative(entry.path(), include).string()] = text;
  }
  return texts;
}

}  // namespace

TEST_CASE("Laws: none reaches into the memory of another") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const auto all = headers(fs::path(source != nullptr ? source : ".") / "include");
  REQUIRE(all.size() > 100);
  for (const auto& [name, text] : all)
    for (const auto& place : reaches(name, text)) FAIL_CHECK(place);
}

TEST_CASE("Laws: a header that does is found") {
  const std::string wrong =
      "struct Memory {\n  typename Tracker::Memory tracker;\n};\n"
      "void move(Memory& m) { m.tracker.plan = {}; }\n";
  CHECK(reaches("a.hpp", wrong).size() == 1);
  const std::string right =
      "struct Memory {\n  typename Tracker::Memory tracker;  // not m.tracker.plan\n};\n"
      "void move(Memory& m) { m.tracker = tracker_.with_target(m.tracker, {}); }\n";
  CHECK(reaches("a.hpp", right).empty());
}

TEST_CASE("Laws: of this library, some hold the memory of another") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const auto all = headers(fs::path(source != nullptr ? source : ".") / "include");
  for (const char* name : {"skinctl/control/force_control.hpp", "skinctl/fusion/null_space.hpp",
                           "skinctl/skills/skill_set.hpp", "skinctl/trajectory/detail/carrying_law.hpp"}) {
    CAPTURE(name);
    auto text = all.at(name);
    const std::regex member(R"(typename\s+\w+::Memory\s+(\w+);)");
    std::smatch held;
    REQUIRE(std::regex_search(text, held, member));
    text += "\nvoid spoil(Memory& m) { m." + held[1].str() + ".plan = {}; }\n";
    CHECK(reaches(name, text).size() == 1);
  }
}
