// Headless Chromium for tests of pages.
#pragma once

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace examples::browser {

namespace fs = std::filesystem;

/// The first of these programs on the path, or what the variable CHROMIUM names.
inline std::string find() {
  if (const char* named = std::getenv("CHROMIUM")) return named;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* name : {"chromium", "chromium-browser"})
      if (::access((folder + '/' + name).c_str(), X_OK) == 0) return folder + '/' + name;
  return {};
}

/// A folder of its own, removed at the end.
struct Folder {
  Folder() {
    std::string name = (fs::temp_directory_path() / "page_in_browser_XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return "file://" + (path / name).string();
  }
  fs::path path;
};

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// Runs the browser with a new profile; it and what it started is ended after a minute.
inline Outcome browse(const std::string& program, const Folder& folder, std::vector<std::string> arguments) {
  static int runs = 0;
  const std::string profile = (folder.path / ("profile" + std::to_string(++runs))).string();
  std::vector<std::string> all{program,
                               "--headless",
                               "--no-sandbox",
                               "--disable-quic",
                               "--no-first-run",
                               "--disable-background-networking",
                               "--disable-component-update",
                               "--disable-sync",
                               "--disable-dev-shm-usage",
                               "--hide-scrollbars",
                               "--user-data-dir=" + profile};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& a : all) argv.push_back(a.data());
  argv.push_back(nullptr);

  int out[2], err[2];
  REQUIRE((::pipe(out) == 0 && ::pipe(err) == 0));
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    ::setpgid(0, 0);
    ::dup2(out[1], 1);
    ::dup2(err[1], 2);
    for (const int end : {out[0], out[1], err[0], err[1]}) ::close(end);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::setpgid(child, child);
  ::close(out[1]);
  ::close(err[1]);

  Outcome outcome;
  pollfd ends[2] = {{out[0], POLLIN, 0}, {err[0], POLLIN, 0}};
  const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  for (int open = 2; open > 0 && std::chrono::steady_clock::now() < late;) {
    if (::poll(ends, 2, 200) <= 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      char part[65536];
      const ssize_t n = ::read(ends[i].fd, part, sizeof part);
      if (n > 0) {
        (i == 0 ? outcome.out : outcome.err).append(part, static_cast<std::size_t>(n));
      } else {
        ends[i].fd = -1;
        --open;
      }
    }
  }
  ::kill(-child, SIGKILL);  // nothing is left of the group when all went well
  int status = 0;
  ::waitpid(child, &status, 0);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  ::close(out[0]);
  ::close(err[0]);
  return outcome;
}

/// Lines that pages wrote to their console, errors of scripts among them.
inline std::string console(const std::string& log) {
  std::string out;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);)
    if (line.find("CONSOLE") != std::string::npos) out += line + '\n';
  return out;
}

}  // namespace examples::browser
