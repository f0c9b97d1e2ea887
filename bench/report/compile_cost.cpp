// Time and peak memory that user files cost their compiler, and what they cost above Eigen/Core alone:
//
//     compile_cost FILE... -- COMPILER FLAG...
//
// A file may state its goal in its first line, `// budget: 4 s 400 MB` or `// budget over eigen_core: 1 s 120
// MB`. Five rounds over all files, medians of each. Returns 1 if a file does not compile or misses its goal.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

constexpr int rounds = 5;

struct Cost {
  double wall = 0;     ///< [s]
  double seconds = 0;  ///< of the processor
  double megabytes = 0;
};

struct Budget {
  std::string over;  // the file to subtract; empty: none
  Cost max;
  bool stated = false;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Runs the compiler on a file. The memory is that of its largest process.
bool compile(const std::vector<std::string>& command, const std::string& file, bool quiet, Cost& cost) {
  std::vector<std::string> words = command;
  words.insert(words.end(), {"-c", file, "-o", "/dev/null"});
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    if (quiet) {
      const int nowhere = open("/dev/null", O_WRONLY);
      dup2(nowhere, STDERR_FILENO);
    }
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child) return false;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  cost = {elapsed.count(), seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) / 1024};
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

Budget read_budget(const std::string& file) {
  std::string line;
  std::getline(std::ifstream(file) >> std::ws, line);
  Budget budget;
  char over[64] = "";
  if (std::sscanf(line.c_str(), "// budget: %lf s %lf MB", &budget.max.seconds, &budget.max.megabytes) == 2) {
    budget.stated = true;
  } else if (std::sscanf(line.c_str(), "// budget over %63[^:]: %lf s %lf MB", over, &budget.max.seconds,
                         &budget.max.megabytes) == 3) {
    budget.stated = true;
    budget.over = over;
  }
  return budget;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::vector<std::string> command;
  bool after = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--") == 0) {
      after = true;
    } else {
      (after ? command : files).emplace_back(argv[i]);
    }
  }
  if (files.empty() || command.empty()) {
    std::fprintf(stderr, "usage: compile_cost FILE... -- COMPILER FLAG...\n");
    return 2;
  }

  std::map<std::string, std::vector<double>> wall;
  std::map<std::string, std::vector<double>> seconds;
  std::map<std::string, std::vector<double>> megabytes;
  bool good = true;
  for (int round = 0; round <= rounds; ++round) {  // the first fills the file cache and is not counted
    for (const auto& file : files) {
      Cost cost;
      if (!compile(command, file, round != 0, cost)) {
        if (round == 0) std::fprintf(stderr, "compile_cost: %s does not compile\n", file.c_str());
        good = false;
        continue;
      }
      if (round == 0) continue;
      wall[file].push_back(cost.wall);
      seconds[file].push_back(cost.seconds);
      megabytes[file].push_back(cost.megabytes);
    }
  }

  std::map<std::string, Cost> costs;
  for (const auto& [file, values] : seconds)
    costs[std::filesystem::path(file).stem()] = {median(wall[file]), median(values), median(megabytes[file])};
  const auto base = costs.find("eigen_core");

  std::printf("%-24s %8s %8s %8s %14s %14s  %s\n", "file", "wall s", "cpu s", "MB", "over Eigen, s",
              "over Eigen, MB", "goal");
  for (const auto& file : files) {
    const std::string name = std::filesystem::path(file).stem();
    if (!costs.contains(name)) continue;
    const Cost cost = costs[name];
    std::printf("%-24s %8.2f %8.2f %8.0f", name.c_str(), cost.wall, cost.seconds, cost.megabytes);
    if (base != costs.end()) {
      std::printf(" %14.2f %14.0f", cost.seconds - base->second.seconds,
                  cost.megabytes - base->second.megabytes);
    } else {
      std::printf(" %14s %14s", "-", "-");
    }
    const Budget budget = read_budget(file);
    if (budget.stated) {
      Cost counted = cost;
      if (!budget.over.empty() && costs.contains(budget.over)) {
        counted.seconds -= costs[budget.over].seconds;
        counted.megabytes -= costs[budget.over].megabytes;
      }
      const bool kept = counted.seconds <= budget.max.seconds && counted.megabytes <= budget.max.megabytes;
      good = good && kept;
      std::printf("  %s%.3g s, %.3g MB: %s", budget.over.empty() ? "" : ("over " + budget.over + " ").c_str(),
                  budget.max.seconds, budget.max.megabytes, kept ? "kept" : "MISSED");
    }
    std::printf("\n");
  }
  std::string line;
  for (const auto& word : command) line += word + " ";
  std::printf("medians of %d: %s\n", rounds, line.c_str());
  return good ? 0 : 1;
}
