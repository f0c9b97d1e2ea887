// For tests: runs a program as a user does.
#pragma once

#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace examples {

/// What `program arguments` writes to both of its outputs. Fails unless it ends within 30 s with the code
/// `expected`.
inline std::string run_program(const std::string& program, const std::string& arguments, int expected) {
  std::FILE* pipe = ::popen(("timeout 30 '" + program + "' " + arguments + " 2>&1").c_str(), "r");
  REQUIRE(pipe);
  std::string out;
  std::array<char, 256> chunk;
  while (std::fgets(chunk.data(), chunk.size(), pipe)) out += chunk.data();
  const int status = ::pclose(pipe);
  CHECK_MESSAGE(WIFEXITED(status), out);
  CHECK_MESSAGE(WEXITSTATUS(status) == expected, out);
  return out;
}

/// Waits until process `id` has a handler for `signal`, at most 30 s: a busy machine may take long to start
/// it.
inline void wait_until_handled(pid_t id, int signal) {
  const std::string path = "/proc/" + std::to_string(id) + "/status";
  for (int k = 0; k < 30'000; ++k) {
    std::ifstream status(path);
    unsigned long long caught = 0;
    for (std::string line; std::getline(status, line);)
      if (line.rfind("SigCgt:", 0) == 0) caught = std::stoull(line.substr(7), nullptr, 16);
    if ((caught >> (signal - 1) & 1) != 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  FAIL("the program never handles signal " << signal);
}

/// The exit code of a program whose outputs nobody reads; it gets `signal`, if not 0, `ms` milliseconds after
/// it began to handle it. Minus the number of the signal that has ended it.
inline int run_and_signal(const char* program, std::vector<const char*> arguments, int signal = 0,
                          int ms = 0) {
  int replaced[2];  // closed where the program takes this one's place, whose handlers it does not inherit
  REQUIRE(::pipe2(replaced, O_CLOEXEC) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    arguments.insert(arguments.begin(), program);
    arguments.push_back(nullptr);
    if (std::freopen("/dev/null", "w", stdout) == nullptr ||
        std::freopen("/dev/null", "w", stderr) == nullptr)
      ::_exit(99);
    ::execv(program, const_cast<char* const*>(arguments.data()));
    ::_exit(98);
  }
  ::close(replaced[1]);
  char nothing = 0;
  CHECK(::read(replaced[0], &nothing, 1) == 0);
  ::close(replaced[0]);
  if (signal != 0) {
    wait_until_handled(child, signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    ::kill(child, signal);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace examples
