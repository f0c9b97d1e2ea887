// not sanitized: for tests that read the tree
#include "tests/support/page_links.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

namespace skinctl::testing {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// The lines of a text outside of its fenced and indented blocks.
std::vector<std::string> prose_lines(const std::string& markdown) {
  std::vector<std::string> lines;
  std::istringstream text(markdown);
  bool fenced = false;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("```", 0) == 0) {
      fenced = !fenced;
    } else if (!fenced && line.rfind("    ", 0) != 0) {
      lines.push_back(line);
    }
  }
  return lines;
}

// A line without what stands between backticks, unless that is the text of a link.
std::string without_code(const std::string& line) {
  std::string out;
  bool code = false;
  for (const char c : line) {
    if (c == '`') {
      code = !code;
    } else if (!code) {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> link_targets(const std::string& markdown) {
  std::vector<std::string> targets;
  for (const auto& whole : prose_lines(markdown)) {
    const std::string line = without_code(whole);
    for (auto at = line.find("]("); at != std::string::npos; at = line.find("](", at + 1)) {
      const auto end = line.find(')', at);
      if (end != std::string::npos) targets.push_back(line.substr(at + 2, end - at - 2));
    }
  }
  return targets;
}

std::vector<std::string> heading_anchors(const std::string& markdown) {
  std::vector<std::string> anchors;
  for (const auto& line : prose_lines(markdown)) {
    const auto level = line.find_first_not_of('#');
    if (level == 0 || level == std::string::npos || line[level] != ' ') continue;
    std::string anchor;
    for (const char c : line.substr(level + 1)) {
      const auto u = static_cast<unsigned char>(c);
      if (c == ' ') {
        anchor += '-';
      } else if (std::isalnum(u) || c == '-' || c == '_' || u >= 0x80) {
        anchor += static_cast<char>(std::tolower(u));
      }
    }
    anchors.push_back(anchor);
  }
  return anchors;
}

std::vector<std::string> link_errors(const fs::path& top) {
  std::vector<std::string> errors;
  std::vector<fs::path> pages;
  for (auto entry = fs::recursive_directory_iterator(top); entry != fs::recursive_directory_iterator();
       ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory()) {
      if ((name.front() == '.' && name != ".github") || name.rfind("build", 0) == 0)
        entry.disable_recursion_pending();
    } else if (entry->path().extension() == ".md") {
      pages.push_back(entry->path());
    }
  }
  std::sort(pages.begin(), pages.end());
  for (const auto& page : pages) {
    for (const auto& target : link_targets(contents(page))) {
      if (target.find("://") != std::string::npos || target.rfind("mailto:", 0) == 0) continue;
      const auto hash = target.find('#');
      const std::string file = target.substr(0, hash);
      const fs::path goal = file.empty() ? page : (page.parent_path() / file).lexically_normal();
      const std::string where = fs::relative(page, top).generic_string() + ": link to " + target;
      if (!fs::exists(goal)) {
        errors.push_back(where + ": there is no such file");
      } else if (fs::relative(goal, top).generic_string().rfind("..", 0) == 0) {
        errors.push_back(where + ": it leaves the repository");
      } else if (hash != std::string::npos && goal.extension() == ".md") {
        const auto anchors = heading_anchors(contents(goal));
        if (std::find(anchors.begin(), anchors.end(), target.substr(hash + 1)) == anchors.end())
          errors.push_back(where + ": that page has no such heading");
      }
    }
  }
  return errors;
}

}  // namespace skinctl::testing
