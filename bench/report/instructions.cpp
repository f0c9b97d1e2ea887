// Instructions that scenes cost an evaluation, counted by callgrind: the same numbers on every run.
//
//     instructions VALGRIND SCENES
//
// Runs each scene of the program SCENES twice, with different numbers of evaluations: the difference is what
// one costs, without what starting the program costs. Code: the lines of 64 bytes that an evaluation touches.
// Beside them what the scene requires, its data, and its times hot and cold.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

namespace {

constexpr long few = 1000, many = 3000;

/// What a command writes, or nothing if it fails.
std::string output(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  char block[4096];
  while (const std::size_t n = std::fread(block, 1, sizeof block, pipe)) text.append(block, n);
  return pclose(pipe) == 0 ? text : std::string();
}
std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

struct Run {
  double instructions = -1;               ///< negative if callgrind did not say
  std::map<unsigned long, double> lines;  ///< how often the busiest instruction of each line of 64 bytes ran
};
Run collected(const std::string& valgrind, const std::string& program, std::size_t scene, long times) {
  Run run;
  char name[] = "/tmp/skinctl_instructions_XXXXXX";
  const int file = mkstemp(name);
  if (file < 0) return run;
  const std::string text = output(quoted(valgrind) +
                                  " --tool=callgrind --dump-instr=yes --compress-pos=no "
                                  "--compress-strings=no --callgrind-out-file=" +
                                  name + " " + quoted(program) + " " + std::to_string(scene) + " " +
                                  std::to_string(times) + " 2>&1");
  const auto at = text.find("Collected : ");
  if (at != std::string::npos) std::sscanf(text.c_str() + at, "Collected : %lf", &run.instructions);
  // A line of costs is `0xADDRESS line cost`; the one behind `calls=` is that of the calls.
  std::ifstream in(name);
  bool call = false;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("0x", 0) == 0) {
      char* end = nullptr;
      const unsigned long address = std::strtoul(line.c_str(), &end, 16);
      std::strtoul(end, &end, 10);
      const double cost = std::strtod(end, nullptr);
      if (!call) {
        double& most = run.lines[address / 64];
        most = cost > most ? cost : most;
      }
      call = false;
    } else if (line.rfind("calls=", 0) == 0) {
      call = true;
    }
  }
  std::remove(name);
  return run;
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fprintf(stderr, "instructions VALGRIND SCENES\n");
    return 2;
  }
  const std::string names = output(quoted(words[2]));
  std::puts(
      "| scene | requires | instructions | code touched [KB] | data [B] | hot [us] | cold [us] "
      "|\n|---|---|---|---|---|---|---|");
  std::size_t scene = 0, failed = names.empty() ? 1 : 0;
  for (std::size_t from = 0; from < names.size(); ++scene) {
    const auto end = names.find('\n', from);
    const Run a = collected(words[1], words[2], scene, few), b = collected(words[1], words[2], scene, many);
    const std::string name = names.substr(from, end - from);
    if (a.instructions < 0 || b.instructions < a.instructions) {
      std::printf("| %s | callgrind gave no count |\n", name.c_str());
      ++failed;
    } else {
      std::size_t lines = 0;
      for (const auto& [line, often] : b.lines) {
        const auto before = a.lines.find(line);
        if (often - (before == a.lines.end() ? 0 : before->second) >= 0.5 * double(many - few)) ++lines;
      }
      char terms[256] = "?";
      unsigned long bytes = 0;
      double hot = 0, cold = 0;
      if (std::sscanf(output(quoted(words[2]) + " " + std::to_string(scene) + " time").c_str(),
                      "%255[^|]|%lu|%lf|%lf", terms, &bytes, &hot, &cold) != 4)
        ++failed;
      std::printf("| %s | %s | %.0f | %.1f | %lu | %.3f | %.2f |\n", name.c_str(), terms,
                  (b.instructions - a.instructions) / double(many - few), double(lines) / 16, bytes, hot,
                  cold);
    }
    std::fflush(stdout);
    from = end == std::string::npos ? names.size() : end + 1;
  }
  return failed == 0 ? 0 : 1;
}
