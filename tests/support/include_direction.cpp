// not sanitized: for tests that read the tree
#include "tests/support/include_direction.hpp"

#include <fstream>
#include <map>
#include <set>

namespace skinctl::testing {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> left_to_the_user = {"io",           "recording", "calibration",
                                                "skin_network", "semantics", "testing"};

std::set<std::string> reachable(const std::map<std::string, std::vector<std::string>>& table,
                                const std::string& folder) {
  std::set<std::string> all = {folder, "core"};
  std::vector<std::string> open = {folder};
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    for (const auto& used : table.at(next))
      if (all.insert(used).second) open.push_back(used);
  }
  return all;
}

// "skinctl/a/b.hpp" of `#include "skinctl/a/b.hpp"`, in quotes or brackets; empty for any other line.
std::string included_header(const std::string& line) {
  auto at = line.find_first_not_of(" \t");
  if (at == std::string::npos || line[at] != '#') return "";
  at = line.find_first_not_of(" \t", at + 1);
  if (at == std::string::npos || line.compare(at, 7, "include") != 0) return "";
  const auto open = line.find_first_of("\"<", at);
  if (open == std::string::npos) return "";
  const auto close = line.find_first_of("\">", open + 1);
  return line.substr(open + 1, close - open - 1);
}

// The folder of "skinctl/a/b.hpp": "a"; of "skinctl/skinctl.hpp": "".
std::string folder_of(const std::string& header) {
  const auto start = header.find('/') + 1;
  const auto end = header.find('/', start);
  return end == std::string::npos ? "" : header.substr(start, end - start);
}

}  // namespace

const std::vector<Folder>& folders() {
  static const std::vector<Folder> table = {
      {"core", {}},
      {"law", {"core"}},
      {"math", {"core"}},
      {"frames", {"math"}},
      {"model", {"frames"}},
      {"kinematics", {"model"}},
      {"dynamics", {"kinematics", "law"}},
      {"robot", {"dynamics"}},
      {"sensing", {"math"}},
      {"tactile", {"dynamics", "sensing"}},
      {"robots", {"tactile"}},
      {"clearance", {"tactile"}},
      {"trajectory", {"frames", "law"}},
      {"tracking", {"robot", "trajectory"}},
      {"control", {"tracking", "tactile"}},
      {"fusion", {"dynamics", "trajectory"}},
      {"limits", {"robot", "clearance"}},
      {"passivity", {"robot", "tactile"}},
      {"resolver", {"limits", "passivity"}},
      {"guard", {"resolver"}},
      {"cycle", {"guard", "trajectory"}},
      {"skills", {"fusion"}},
      {"hardware", {"cycle"}},
      {"skin_network", {"core"}},
      {"calibration", {"tactile", "trajectory", "skin_network"}},
      {"semantics", {"skills", "cycle"}},
      {"testing", {"control", "fusion", "skills", "hardware", "calibration", "semantics", "robots"}},
      {"io", {"robot", "robots", "clearance"}},
      {"recording", {"cycle", "io"}},
  };
  return table;
}

std::vector<std::string> include_errors(const fs::path& include) {
  std::map<std::string, std::vector<std::string>> table;
  for (const auto& folder : folders()) table[folder.name] = folder.may_use;

  std::set<std::string> headers;
  for (const auto& entry : fs::recursive_directory_iterator(include / "skinctl"))
    if (entry.is_regular_file() && entry.path().extension() == ".hpp")
      headers.insert(fs::relative(entry.path(), include).generic_string());

  const std::string umbrella = "skinctl/skinctl.hpp";
  std::vector<std::string> errors;
  std::set<std::string> in_umbrella;
  for (const auto& header : headers) {
    const std::string folder = folder_of(header);
    if (header != umbrella && !table.contains(folder)) {
      errors.push_back(header + ": its folder is not in the table");
      continue;
    }
    std::set<std::string> allowed;
    if (header != umbrella) allowed = reachable(table, folder);

    std::ifstream file(include / header);
    for (std::string line; std::getline(file, line);) {
      const std::string used = included_header(line);
      if (used.rfind("skinctl/", 0) != 0) {
        if (header == umbrella && !line.empty() && line.rfind("//", 0) != 0 && line != "#pragma once")
          errors.push_back(header + ": holds more than includes: " + line);
        continue;
      }
      if (!headers.contains(used)) {
        errors.push_back(header + " includes " + used + ", which does not exist");
      } else if (header == umbrella) {
        in_umbrella.insert(used);
        if (left_to_the_user.contains(folder_of(used)))
          errors.push_back(header + " must not include " + used);
      } else if (!allowed.contains(folder_of(used))) {
        errors.push_back(header + " includes " + used + ": " + folder + "/ may not use " + folder_of(used) +
                         "/");
      }
    }
  }
  for (const auto& header : headers) {
    const bool wanted = header != umbrella && header.find("/detail/") == std::string::npos &&
                        !left_to_the_user.contains(folder_of(header));
    if (wanted && !in_umbrella.contains(header)) errors.push_back(umbrella + " lacks " + header);
  }
  return errors;
}

}  // namespace skinctl::testing
