// Runs programs that print, and compares what they print with what a page shows.
#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace skinctl::testing {

struct ShownProgram {
  const char* heading;
  void (*run)();
  const char* shown;  ///< what the page says that it prints
};

/// What `run` writes to the standard output.
inline std::string printed_by(void (*run)()) {
  std::FILE* file = std::tmpfile();
  const int output = dup(STDOUT_FILENO);
  if (file == nullptr || output < 0) return "no temporary file";
  std::fflush(stdout);
  dup2(fileno(file), STDOUT_FILENO);
  run();
  std::fflush(stdout);
  dup2(output, STDOUT_FILENO);
  close(output);
  std::rewind(file);
  std::string text;
  for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
  std::fclose(file);
  return text;
}

/// Runs those whose heading has the first argument in it, or all. 1 if one prints something else than the
/// page shows, or none ran.
inline int compare(int argc, char** argv, const std::vector<ShownProgram>& programs) {
  int different = 0, run = 0;
  for (const auto& program : programs) {
    if (argc > 1 && std::string_view(program.heading).find(argv[1]) == std::string_view::npos) continue;
    ++run;
    const std::string printed = printed_by(program.run);
    const bool same = printed == program.shown;
    std::printf("%s: %s\n", program.heading, same ? "as shown" : "prints");
    if (!same) std::printf("%sthe page shows\n%s", printed.c_str(), program.shown);
    different += !same;
  }
  std::printf("%d blocks of the page ran, %d print something else than it shows\n", run, different);
  return different > 0 || run == 0;
}

}  // namespace skinctl::testing
