// not sanitized: it reads the tree, and runs nothing of the library
// Every public function that takes numbers is tried at the ends of what a number holds: by name if it is free, with its class if
// it is a member; a class whose set-up is long, in its own test, which then feeds numbers that are none.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/public_functions.hpp"

using namespace skinctl::testing;
namespace fs = std::filesystem;

namespace {

/// What is tried elsewhere: texts and bytes from outside by fuzzing (tests/io, the programs of tests/fuzz), fits of
/// recordings and rules by their own tests, which feed them wrong files, and what is for tests.
const std::vector<std::string> elsewhere = {"io", "testing", "calibration", "semantics"};

/// Words of parameters that bring no number of the user's. A type that is not here does.
const std::set<std::string> numberless = {
    // language
    "const", "std", "size_t", "ptrdiff_t", "bool", "char", "int", "unsigned", "int32_t", "uint8_t",
    "uint16_t", "uint32_t", "uint64_t", "typename", "tuple", "auto", "same_as", "true", "false",
    // texts
    "string", "string_view", "ErrorHandler",
    // what is called back, and written to
    "F", "Test", "Out", "Before", "After",
    // models, robots and laws: their numbers went in when they were built
    "M", "L", "K", "P", "Robot", "Law", "Fused", "R", "Part", "Parts", "LinkContact", "Patch", "Load", "C",
    "Skill", "Terms", "Library", "SkillController", "Name", "OneGripper", "First", "Others", "I", "N",
    "Recording", "SkillSettings", "JointLimits", "Source", "LoopOptions", "NamedCell", "CellGains", "Side",
    "allegro",
    // what a stage has written itself
    "Memory",
    // sets
    "Needs", "LinkMask", "Status", "SkillSwitches", "LaneMask",
    // enumerations
    "Reason", "Reaction", "WayBack", "FaultFinder", "CycleStage", "JointKind", "GripperError", "CellFault",
    "NoiseFinding", "SkillFailure", "NoSkin", "NoGoal"};

/// Templates that are checked when they are built.
const std::set<std::string> built_before = {"JointLimits", "Fused", "Patch",           "Recording",
                                            "LinkContact", "Load",  "SkillController", "NamedCell"};

/// Where a test feeds what is no number, one of these stands.
const std::set<std::string> hostile_words = {"quiet_NaN", "infinity", "nan", "nanf", "HUGE_VAL", "NAN"};

std::vector<std::string> words(const std::string& parameter) {
  std::vector<std::string> out;
  std::istringstream in(parameter);
  int built = 0;  // depth in the arguments of a type whose numbers went in when it was built
  for (std::string w; in >> w;) {
    if (w == "=") break;
    if (w == "(") {  // an array's own name: `( & cells )`
      while (in >> w && w != ")") {
      }
      continue;
    }
    if (w == "<" && (built > 0 || (!out.empty() && built_before.count(out.back()) != 0))) {
      ++built;
    } else if (w == ">" && built > 0) {
      --built;
    } else if (built == 0 && (std::isalpha(static_cast<unsigned char>(w[0])) != 0 || w[0] == '_')) {
      out.push_back(w);
    }
  }
  return out;
}
/// Whether a parameter may bring a number: by its type, all its words but the last, its own name, if it has one.
bool brings_numbers(const PublicFunction& f) {
  std::vector<std::string> parameters(1);
  int depth = 0;
  std::istringstream in(f.parameters);
  for (std::string w; in >> w;) {
    if (w == "<" || w == "(" || w == "{") ++depth;
    if (w == ">" || w == ")" || w == "}") --depth;
    if (w == "," && depth == 0)
      parameters.emplace_back();
    else
      parameters.back() += w + " ";
  }
  for (const auto& parameter : parameters) {
    auto all = words(parameter);
    if (all.size() > 1 && std::islower(static_cast<unsigned char>(all.back()[0])) != 0 &&
        parameter.find(": : " + all.back()) == std::string::npos &&
        parameter.find(":: " + all.back()) == std::string::npos)
      all.pop_back();
    for (const auto& w : all)
      if (numberless.count(w) == 0) return true;
  }
  return false;
}

/// The names in a text, those in quotes too, without comments.
std::set<std::string> names_in(const std::string& text) {
  std::set<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find("//"));
    std::string word;
    for (const char c : line + " ") {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
        word += c;
      } else {
        if (!word.empty()) out.insert(word);
        word.clear();
      }
    }
  }
  return out;
}

struct Missing {
  std::set<std::string> functions, classes;
  std::size_t free = 0, members = 0, named_members = 0, elsewhere = 0;
};
/// @param named    in tests/extremes.
/// @param hostile  in tests that feed numbers that are none.
Missing missing(const std::vector<PublicFunction>& all, const std::set<std::string>& named,
                const std::set<std::string>& hostile) {
  Missing out;
  std::set<std::string> seen, classes;
  for (const auto& f : all) {
    if (!brings_numbers(f) || !seen.insert(f.label()).second) continue;
    if (f.of.empty()) {
      ++out.free;
      if (named.count(f.name) == 0) out.functions.insert(f.header + ": " + f.name);
      continue;
    }
    ++out.members;
    if (named.count(f.name) != 0) ++out.named_members;
    const std::string of = f.of.substr(0, f.of.find("::"));
    if (named.count(of) != 0 || !classes.insert(of).second) continue;
    if (hostile.count(of) != 0)
      ++out.elsewhere;
    else
      out.classes.insert(f.header + ": " + of);
  }
  return out;
}

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}
/// The names in all tests, file by file, that hold a NaN or an infinity.
std::set<std::string> names_in_hostile(const fs::path& tests) {
  std::set<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(tests)) {
    if (entry.path().extension() != ".cpp") continue;
    const auto names = names_in(text_of(entry.path()));
    if (std::any_of(hostile_words.begin(), hostile_words.end(),
                    [&](const auto& w) { return names.count(w) != 0; }))
      out.insert(names.begin(), names.end());
  }
  return out;
}

}  // namespace

TEST_CASE("Extremes: every public function that takes numbers is tried, a member with its class") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const fs::path root(source != nullptr ? source : ".");
  const auto all = public_functions(root / "include", elsewhere);
  REQUIRE(all.size() > 1000);
  std::string tests;
  for (const auto& entry : fs::directory_iterator(root / "tests/extremes"))
    tests += text_of(entry.path()) + "\n";
  const auto without = missing(all, names_in(tests), names_in_hostile(root / "tests"));
  MESSAGE(without.free << " free functions that take numbers, " << without.functions.size()
                       << " of them not tried; " << without.members << " members, " << without.named_members
                       << " by name; " << without.elsewhere << " classes in other tests, "
                       << without.classes.size() << " not tried");
  for (const auto& name : without.functions) FAIL_CHECK("no row in tests/extremes: " << name);
  for (const auto& name : without.classes) FAIL_CHECK("no row in tests/extremes for a class: " << name);
}

TEST_CASE("Extremes: a new function without a row is found, and what takes no numbers is not asked for one") {
  const std::string header =
      "SKINCTL_BEGIN_NAMESPACE\n"
      "template <Real T>\n  requires std::floating_point<T>\n[[nodiscard]] T doubled(const T& x) noexcept { "
      "return 2 * x; }\n"
      "constexpr const char* name(Reason r) noexcept;\n"
      "namespace detail { double hidden(double x); }\n"
      "class Gate {\n public:\n  explicit Gate(double from = {}) : from_{from} { check(from); }\n"
      "  void move(double x) = delete;\n  double at(double x) const;\n  double from() const { return from_; "
      "}\n"
      " private:\n  void check(double x);\n  double from_;\n};\nSKINCTL_END_NAMESPACE\n";
  const auto all = public_functions("skinctl/core/new.hpp", header);
  const auto found = missing(all, {}, {});
  CHECK(found.functions == std::set<std::string>{"skinctl/core/new.hpp: doubled"});
  CHECK(found.classes == std::set<std::string>{"skinctl/core/new.hpp: Gate"});
  CHECK((found.free == 1 && found.members == 2));
  const auto tried = missing(all, names_in("{\"doubled\", 1}  // Gate"), {"Gate"});
  CHECK((tried.functions.empty() && tried.classes.empty() && tried.elsewhere == 1));
}
