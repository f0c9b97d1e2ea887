// Merges the results of the benchmark programs into one file of Google Benchmark's format and prints how
// skinctl compares with the peers and the hand-written floor:
//
//     benchmark_report OUTPUT.json key=value... RESULT.json...
//
// Names are area/job/scene/implementation/scalar.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace {

using nlohmann::ordered_json;

struct Timing {
  std::vector<double> nanoseconds;  // one a repetition
  double allocations = -1;          // a call; -1: not counted

  [[nodiscard]] double median() const {
    auto sorted = nanoseconds;
    std::sort(sorted.begin(), sorted.end());
    const auto middle = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
  }
  [[nodiscard]] double maximum() const { return *std::max_element(nanoseconds.begin(), nanoseconds.end()); }
};

struct Name {
  std::string row;             // area/job/scene/scalar: what is compared
  std::string implementation;  // skinctl, floor, kdl, ...
};

bool parse(const std::string& text, Name& name) {
  std::vector<std::string> parts{""};
  for (char c : text) {
    if (c == '/') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() < 5) return false;  // what follows the scalar are Google Benchmark's own suffixes
  name.row = parts[0] + "/" + parts[1] + "/" + parts[2] + "/" + parts[4];
  name.implementation = parts[3];
  return true;
}

/// Google Benchmark writes the coefficient of variation of zero allocations as NaN, which JSON does not know.
std::string without_nan(std::istream& file) {
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string nan = "\": NaN";
  for (auto at = text.find(nan); at != std::string::npos; at = text.find(nan, at))
    text.replace(at, nan.size(), "\": null");
  return text;
}

double to_nanoseconds(const std::string& unit) {
  if (unit == "us") return 1e3;
  if (unit == "ms") return 1e6;
  if (unit == "s") return 1e9;
  return 1;
}

bool is_ours(const std::string& implementation) {
  return implementation.rfind("skinctl", 0) == 0;
}

using Rows = std::map<std::string, std::map<std::string, Timing>>;

void print(const Rows& rows) {
  std::set<std::string> others;
  for (const auto& [row, timings] : rows) {
    for (const auto& [implementation, timing] : timings) {
      if (!is_ours(implementation) && implementation != "floor") others.insert(implementation);
    }
  }
  std::vector<std::string> columns(others.begin(), others.end());
  columns.insert(columns.begin(), "floor");

  std::size_t width = 3;
  for (const auto& [row, timings] : rows) {
    for (const auto& [implementation, timing] : timings) {
      const bool variant = is_ours(implementation) && implementation != "skinctl";
      width = std::max(width, row.size() + (variant ? implementation.size() + 3 : 0));
    }
  }
  const int w = static_cast<int>(width);
  std::printf("\n%-*s %10s %10s %7s", w, "ns", "skinctl", "max", "allocs");
  for (const auto& column : columns) {
    std::printf(" %19s", (column == "floor" ? "floor (ours/floor)" : column + " (peer/ours)").c_str());
  }
  std::printf("\n");

  for (const auto& [row, timings] : rows) {
    bool any = false;
    for (const auto& [implementation, ours] : timings) {
      if (!is_ours(implementation)) continue;
      any = true;
      const std::string label = implementation == "skinctl" ? row : row + " [" + implementation + "]";
      std::printf("%-*s %10.1f %10.1f", w, label.c_str(), ours.median(), ours.maximum());
      if (ours.allocations >= 0) {
        std::printf(" %7.3f", ours.allocations);
      } else {
        std::printf(" %7s", "?");
      }
      for (const auto& column : columns) {
        const auto other = timings.find(column);
        if (other == timings.end()) {
          std::printf(" %19s", "-");
          continue;
        }
        const double theirs = other->second.median();
        const double ratio = column == "floor" ? ours.median() / theirs : theirs / ours.median();
        std::printf(" %10.1f %7.2fx", theirs, ratio);
      }
      std::printf("\n");
    }
    if (any) continue;
    std::printf("%-*s %10s %10s %7s", w, row.c_str(), "-", "-", "-");
    for (const auto& column : columns) {
      const auto other = timings.find(column);
      if (other == timings.end()) {
        std::printf(" %19s", "-");
      } else {
        std::printf(" %10.1f %8s", other->second.median(), "");
      }
    }
    std::printf("\n");
  }
}

/// What each law costs, and its share of the whole cycle (1260 cells; with a law of the joints, and of a
/// tool): where these rows were measured.
void print_shares(const Rows& rows) {
  const auto ours = [&](const std::string& row) {
    const auto found = rows.find(row);
    if (found == rows.end() || !found->second.contains("skinctl")) return 0.0;
    return found->second.at("skinctl").median();
  };
  for (const std::string scalar : {"double", "float"}) {
    const double joints = ours("cycle/evaluation/ur5-1260/" + scalar);
    const double tool = ours("cycle/evaluation/ur5-1260-operational/" + scalar);
    if (joints <= 0 || tool <= 0) continue;
    const std::string end = "/ur5/" + scalar;
    std::printf("\n%-44s %10s %14s %14s\n", ("law alone, " + scalar).c_str(), "ns", "of the cycle",
                "of a tool's");
    for (const auto& [row, timings] : rows) {
      if (row.rfind("control/", 0) != 0 || !row.ends_with(end) || ours(row) <= 0) continue;
      const auto law = row.substr(8, row.size() - 8 - end.size());
      std::printf("%-44s %10.1f %12.0f %% %12.0f %%\n", law.c_str(), ours(row), 100 * ours(row) / joints,
                  100 * ours(row) / tool);
    }
    std::printf("%-44s %10.1f %14s %10.1f ns\n", "the cycle", joints, "", tool);
  }
}
}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: benchmark_report OUTPUT.json key=value... RESULT.json...\n");
    return 2;
  }
  ordered_json merged;
  std::vector<std::pair<std::string, std::string>> added;
  Rows rows;
  for (int i = 2; i < argc; ++i) {
    const std::string argument = argv[i];
    if (const auto equals = argument.find('='); equals != std::string::npos) {
      added.emplace_back(argument.substr(0, equals), argument.substr(equals + 1));
      continue;
    }
    std::ifstream file(argument);
    if (!file) throw std::runtime_error("cannot read " + argument);
    if (file.peek() == std::ifstream::traits_type::eof()) continue;  // a filter left nothing of this program
    const auto result = ordered_json::parse(without_nan(file));
    if (!merged.contains("context")) {
      merged["context"] = result.at("context");
      merged["benchmarks"] = ordered_json::array();
    }
    for (const auto& benchmark : result.at("benchmarks")) {
      merged["benchmarks"].push_back(benchmark);
      if (benchmark.value("run_type", "") != "iteration") continue;
      Name name;
      const std::string text = benchmark.at("run_name");
      if (benchmark.value("error_occurred", false)) {
        std::printf("%s: %s\n", text.c_str(), benchmark.value("error_message", "error").c_str());
        continue;
      }
      if (!parse(text, name)) {
        std::printf("%s: not area/job/scene/implementation/scalar, left out of the table\n", text.c_str());
        continue;
      }
      auto& timing = rows[name.row][name.implementation];
      timing.nanoseconds.push_back(benchmark.at("cpu_time").get<double>() *
                                   to_nanoseconds(benchmark.value("time_unit", "ns")));
      timing.allocations = std::max(timing.allocations, benchmark.value("allocs", -1.0));
    }
  }
  merged["context"].erase("executable");
  for (const auto& [key, value] : added) merged["context"][key] = value;

  std::ofstream output(argv[1]);
  output << merged.dump(1) << "\n";
  if (!output) throw std::runtime_error(std::string("cannot write ") + argv[1]);
  print(rows);
  print_shares(rows);
  for (const auto& [key, value] : added) std::printf("%s: %s\n", key.c_str(), value.c_str());
  std::printf("median (and maximum) of the repetitions; all in %s\n", argv[1]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "benchmark_report: %s\n", error.what());
  return 1;
}
