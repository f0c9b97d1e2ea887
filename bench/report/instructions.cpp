// Instructions that scenes cost an evaluation, counted by callgrind: the same numbers on every run.
//
//     instructions VALGRIND SCENES
//
// Runs each scene of the program SCENES twice, with different numbers of evaluations: the difference is what
// one costs, without what starting the program costs.
#include <cstdio>
#include <string>
#include <vector>

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

/// Instructions of one run; negative if callgrind did not say.
double collected(const std::string& valgrind, const std::string& program, std::size_t scene, long times) {
  const std::string text =
      output(quoted(valgrind) + " --tool=callgrind --callgrind-out-file=/dev/null " + quoted(program) + " " +
             std::to_string(scene) + " " + std::to_string(times) + " 2>&1");
  const auto at = text.find("Collected : ");
  double count = -1;
  if (at != std::string::npos) std::sscanf(text.c_str() + at, "Collected : %lf", &count);
  return count;
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fprintf(stderr, "instructions VALGRIND SCENES\n");
    return 2;
  }
  const std::string names = output(quoted(words[2]));
  std::puts("| scene | instructions an evaluation |\n|---|---|");
  std::size_t scene = 0, failed = names.empty() ? 1 : 0;
  for (std::size_t from = 0; from < names.size(); ++scene) {
    const auto end = names.find('\n', from);
    const double a = collected(words[1], words[2], scene, few),
                 b = collected(words[1], words[2], scene, many);
    if (a < 0 || b < a) {
      std::printf("| %s | callgrind gave no count |\n", names.substr(from, end - from).c_str());
      ++failed;
    } else {
      std::printf("| %s | %.0f |\n", names.substr(from, end - from).c_str(), (b - a) / double(many - few));
    }
    std::fflush(stdout);
    from = end == std::string::npos ? names.size() : end + 1;
  }
  return failed == 0 ? 0 : 1;
}
