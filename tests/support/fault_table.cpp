// not sanitized: for tests that read the tree
#include "tests/support/fault_table.hpp"

#include <fstream>
#include <regex>
#include <sstream>

#include "skinctl/guard/faults.hpp"

namespace skinctl::testing {

std::string fault_table() {
  std::ostringstream out;
  out << "| reason | in words | found by | by position or velocity | by torque | ends |\n"
         "|---|---|---|---|---|---|\n";
  for (const Fault& f : faults)
    out << "| `" << f.name << "` | " << f.text << " | " << name(f.finder) << " | " << name(f.motion) << " | "
        << name(f.torque) << " | " << name(f.way_back) << " |\n";
  return out.str();
}

std::string fault_block(const std::string& markdown) {
  const std::string begin = "<!-- faults:begin -->\n", end = "<!-- faults:end -->";
  const auto from = markdown.find(begin);
  if (from == std::string::npos) return {};
  const auto to = markdown.find(end, from);
  if (to == std::string::npos) return {};
  return markdown.substr(from + begin.size(), to - from - begin.size());
}

std::vector<std::string> reasons_in(const std::string& header) {
  std::vector<std::string> out;
  std::smatch body;
  if (!std::regex_search(header, body, std::regex(R"(enum class Reason[^{]*\{([^}]*)\})"))) return out;
  const std::string text = std::regex_replace(body[1].str(), std::regex("//[^\n]*"), "");
  const std::regex word("[A-Za-z_][A-Za-z_0-9]*");
  for (std::sregex_iterator it(text.begin(), text.end(), word), last; it != last; ++it)
    if (it->str() != "count") out.push_back(it->str());
  return out;
}

std::vector<std::string> reasons_set_by(const std::string& source) {
  std::string text = std::regex_replace(source, std::regex("//[^\n]*"), "");
  text = std::regex_replace(text, std::regex(R"(has\(\s*Reason::\w+\s*\))"), "");
  text = std::regex_replace(text, std::regex(R"([~&]\s*Status\(\s*Reason::\w+\s*\))"), "");
  std::vector<std::string> out;
  const std::regex named(R"(Reason::([a-z_]+))");
  for (std::sregex_iterator it(text.begin(), text.end(), named), last; it != last; ++it)
    out.push_back((*it)[1].str());
  return out;
}

std::map<std::string, std::string> producers(const std::filesystem::path& include) {
  std::map<std::string, std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(include)) {
    if (entry.path().extension() != ".hpp") continue;
    const auto header = std::filesystem::relative(entry.path(), include).generic_string();
    if (header == "skinctl/core/status.hpp" || header == "skinctl/guard/faults.hpp" ||
        header.starts_with("skinctl/testing/"))
      continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    for (const auto& reason : reasons_set_by(text.str())) out.emplace(reason, header);
  }
  return out;
}

}  // namespace skinctl::testing
