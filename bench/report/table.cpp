// One markdown table from the results of several builds:
//
//     benchmark_table RESULTS.json...
//
// A row a benchmark of skinctl, a column a build: ns (median), and in parentheses the ratio to the floor,
// then how many times longer each peer takes.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

/// The compiler's name and the set of instructions, of the context that `run_benchmarks` leaves.
std::string title(const nlohmann::json& context) {
  const std::string compiler = context.value("compiler", "?"), flags = context.value("flags", "");
  const auto at = flags.find("-march=");
  const std::string name = compiler.rfind("GNU", 0) == 0 ? "GCC" + compiler.substr(3) : compiler;
  return name.substr(0, name.find('.')) + (at == std::string::npos ? ", plain" : ", " + flags.substr(at + 7));
}

using Samples = std::vector<double>;
using Implementations = std::map<std::string, Samples>;  // by name: skinctl, floor, kdl, ...
using Rows = std::map<std::string, Implementations>;     // by area/job/scene/scalar

double fastest(const Samples& x) {
  return *std::min_element(x.begin(), x.end());
}

Rows read(const nlohmann::json& results) {
  Rows rows;
  for (const auto& b : results.at("benchmarks")) {
    if (b.value("run_type", "") != "iteration") continue;
    std::vector<std::string> part{""};
    for (char c : b.at("run_name").get<std::string>()) {
      if (c == '/') {
        part.emplace_back();
      } else {
        part.back() += c;
      }
    }
    if (part.size() < 5) continue;
    rows[part[0] + "/" + part[1] + " " + part[2] + " " + part[4]][part[3]].push_back(
        b.at("cpu_time").get<double>());
  }
  return rows;
}

std::string cell(const Implementations& all) {
  const double ours = fastest(all.at("skinctl"));
  char text[64];
  std::snprintf(text, sizeof text, ours < 100 ? "%.1f" : "%.0f", ours);
  std::string out = text, notes;
  for (const char* peer : {"floor", "kdl", "kdl_per_link", "kdl_per_cell", "mujoco", "pinocchio"}) {
    const auto at = all.find(peer);
    if (at == all.end()) continue;
    const std::string name = peer;
    if (name == "floor") {
      std::snprintf(text, sizeof text, "floor %.2f", ours / fastest(at->second));
    } else {
      std::snprintf(text, sizeof text, "%s%s %.0fx", notes.empty() ? "" : ", ", peer,
                    fastest(at->second) / ours);
    }
    notes += text;
  }
  return notes.empty() ? out : out + " (" + notes + ")";
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> titles;
  std::vector<Rows> builds;
  Rows names;
  for (int i = 1; i < argc; ++i) {
    std::ifstream file(argv[i]);
    if (!file) throw std::runtime_error(std::string("cannot read ") + argv[i]);
    const auto results = nlohmann::json::parse(file);
    titles.push_back(title(results.at("context")));
    builds.push_back(read(results));
    for (const auto& [name, row] : builds.back())
      if (row.contains("skinctl")) names[name];
  }
  std::printf("| ns (ours / floor, peer / ours) |");
  for (const auto& t : titles) std::printf(" %s |", t.c_str());
  std::printf("\n|---|");
  for (std::size_t i = 0; i < titles.size(); ++i) std::printf("---|");
  std::printf("\n");
  for (const auto& [name, unused] : names) {
    std::printf("| %s |", name.c_str());
    for (const auto& rows : builds) {
      const auto at = rows.find(name);
      std::printf(" %s |",
                  at == rows.end() || !at->second.contains("skinctl") ? "-" : cell(at->second).c_str());
    }
    std::printf("\n");
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "benchmark_table: %s\n", error.what());
  return 1;
}
