// not sanitized: for tests that read the tree
#include "tests/support/readme_blocks.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace skinctl::testing {
namespace {

std::string trimmed(const std::string& line) {
  const auto start = line.find_first_not_of(" \t");
  if (start == std::string::npos) return "";
  return line.substr(start, line.find_last_not_of(" \t\r") - start + 1);
}

std::string without_common_indentation(const std::vector<std::string>& lines) {
  std::size_t indentation = std::string::npos;
  for (const auto& line : lines) indentation = std::min(indentation, line.find_first_not_of(' '));
  std::string text;
  for (const auto& line : lines) text += (trimmed(line).empty() ? "" : line.substr(indentation)) + "\n";
  return text;
}

}  // namespace

std::vector<std::string> cpp_blocks(const std::string& markdown) {
  std::vector<std::string> blocks;
  std::istringstream text(markdown);
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (!inside && trimmed(line) == "```cpp") {
      inside = true;
      blocks.emplace_back();
    } else if (inside && trimmed(line) == "```") {
      inside = false;
    } else if (inside) {
      blocks.back() += line + "\n";
    }
  }
  return blocks;
}

std::vector<ShownBlock> shown_programs(const std::string& markdown) {
  std::vector<ShownBlock> blocks;
  std::istringstream text(markdown);
  std::string heading, fence;
  std::size_t number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (fence.empty()) {
      if (line.rfind("```", 0) == 0) fence = line;
      if (line.rfind('#', 0) == 0) heading = trimmed(line.substr(line.find_first_not_of('#')));
      if (fence == "```cpp") blocks.push_back({heading, number + 1, "", ""});
      if (fence == "```text" && (blocks.empty() || !blocks.back().printed.empty()))
        throw std::runtime_error("a block of text without a program: line " + std::to_string(number));
    } else if (line == "```") {
      fence.clear();
    } else if (fence == "```cpp") {
      blocks.back().code += line + "\n";
    } else if (fence == "```text") {
      blocks.back().printed += line + "\n";
    }
  }
  return blocks;
}

std::map<std::string, std::string> marked_regions(const std::string& source) {
  std::map<std::string, std::string> regions;
  std::map<std::string, std::vector<std::string>> open;
  std::istringstream text(source);
  for (std::string line; std::getline(text, line);) {
    const std::string mark = trimmed(line);
    if (mark.rfind("// [readme:", 0) == 0 && mark.back() == ']') {
      open[mark.substr(11, mark.size() - 12)];
    } else if (mark.rfind("// [/readme:", 0) == 0 && mark.back() == ']') {
      const std::string name = mark.substr(12, mark.size() - 13);
      if (!open.contains(name)) throw std::runtime_error("readme region ends that never began: " + name);
      regions[name] = without_common_indentation(open[name]);
      open.erase(name);
    } else {
      for (auto& [name, lines] : open) lines.push_back(line);
    }
  }
  if (!open.empty()) throw std::runtime_error("readme region without an end: " + open.begin()->first);
  return regions;
}

}  // namespace skinctl::testing
