// not sanitized: it reads the tree, and runs nothing of the library
#include <doctest/doctest.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <istream>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

// The words of a line of code: letters, digits and underscores.
std::vector<std::string> words_of(const std::string& code) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : code + ' ') {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
      word += c;
    } else if (!word.empty()) {
      words.push_back(word);
      word.clear();
    }
  }
  return words;
}

// What the glossary calls otherwise: guard, governor, passivity; max, min.
bool wrong_name(const std::string& word) {
  for (const char* other : {"Watchman", "watchman", "Keeper", "keeper", "Overseer", "overseer"})
    if (word.find(other) != std::string::npos) return true;
  return word.starts_with("most_") || (word.starts_with("least_") && !word.starts_with("least_squares"));
}

// A field's comment is a noun phrase that reads alone: it begins with no pronoun.
bool wrong_comment(const std::string& comment) {
  for (const char* pronoun :
       {"that of", "those of", "the same", "an empty one", "it ", "its ", "what ", "one of them"})
    if (comment.starts_with(pronoun)) return true;
  return false;
}

std::vector<std::string> wrong_words(std::istream& header) {
  std::vector<std::string> found;
  for (std::string line; std::getline(header, line);) {
    const auto comment = line.find("//");
    for (const auto& word : words_of(line.substr(0, comment)))
      if (wrong_name(word)) found.push_back(word);
    const auto field = line.find("///< ");
    if (field != line.npos && wrong_comment(line.substr(field + 5))) found.push_back(line.substr(field));
  }
  return found;
}

}  // namespace

TEST_CASE("Words: names and comments of fields are the glossary's, in every header") {
  const char* source = std::getenv("SKINCTL_SOURCE_DIR");
  const fs::path root = fs::path(source != nullptr ? source : ".") / "include/skinctl";
  std::size_t headers = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const fs::path path = fs::relative(entry.path(), root);
    if (path.extension() != ".hpp") continue;
    ++headers;
    std::ifstream header(entry.path());
    for (const auto& wrong : wrong_words(header)) FAIL_CHECK(path.string() << ": " << wrong);
  }
  CHECK(headers > 100);
}

TEST_CASE("Words: other names and pronouns are found") {
  std::istringstream header(
      "class Watchman;\nint most_cells = 8;\nint least_squares = 1;  ///< almost the same\n"
      "double far = 0;  ///< an empty one [s]\n// a keeper\n");
  CHECK(wrong_words(header) == std::vector<std::string>{"Watchman", "most_cells", "///< an empty one [s]"});
}
