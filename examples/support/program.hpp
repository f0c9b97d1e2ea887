// What the mains of programs share: their options, and what becomes of an error.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>

#include "examples/support/exit.hpp"
#include "skinctl/core/contract.hpp"

namespace examples::job {

/// Reads the options. The exit code of a program that was asked for `--help`, or whose options are wrong;
/// else none.
[[nodiscard]] inline std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    return code(app.exit(e) == 0 ? Exit::fine : Exit::refused);
  }
}

/// The exit code of a job. A job that ended otherwise than it should says how, and why if that is known.
[[nodiscard]] inline int ended(const char* program, Exit end, const std::string& why) {
  if (end != Exit::fine)
    std::fprintf(stderr, "%s: %s%s%s\n", program, words(end), why.empty() ? "" : ": ", why.c_str());
  return code(end);
}

/// `run(argc, argv)`, which returns an exit code. What it throws is said: `refused` for a wrong number, file
/// or option, `lost` for all else.
[[nodiscard]] inline int main_of(const char* program, int (*run)(int, char**), int argc, char** argv) {
  Exit end = Exit::lost;
  try {
    return run(argc, argv);
  } catch (const skinctl::ConfigurationError& e) {
    end = Exit::refused;
    std::fprintf(stderr, "%s: %s\n", program, e.what());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
  }
  return code(end);
}

}  // namespace examples::job
