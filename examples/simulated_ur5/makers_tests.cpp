// Runs the integration tests of the makers' C++ client, where a user has them built, against the simulated UR5.
// Nothing of that client is in this repository: its tests are programs in a folder that the user names (built with
// -DINTEGRATION_TESTS=ON). Those that want a robot are run as the client's own ctest runs them, `--robot_ip 127.0.0.1`,
// `--headless true` or `false`, in its folder `tests`, each beside a fresh simulator on the standard ports, and what
// they print is counted.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

/// A child process whose standard output is read line by line.
class Child {
 public:
  explicit Child(const Arguments& arguments, const std::string& folder = ".") {
    int pipe_ends[2];
    if (::pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    id_ = ::fork();
    if (id_ == 0) {
      ::dup2(pipe_ends[1], 1);
      if (::chdir(folder.c_str()) != 0) ::_exit(126);
      std::vector<char*> raw;
      for (const auto& a : arguments) raw.push_back(const_cast<char*>(a.c_str()));
      raw.push_back(nullptr);
      ::execv(raw[0], raw.data());
      ::_exit(127);
    }
    ::close(pipe_ends[1]);
    out_ = ::fdopen(pipe_ends[0], "r");
    if (id_ < 0 || !out_) throw std::runtime_error("cannot run " + arguments[0]);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::kill(id_, SIGTERM);
    if (!ended_) ::waitpid(id_, nullptr, 0);
    std::fclose(out_);
  }
  bool line(std::string& text) {
    std::array<char, 4096> buffer{};
    if (!std::fgets(buffer.data(), static_cast<int>(buffer.size()), out_)) return false;
    text = buffer.data();
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    return true;
  }
  /// Waits for the end; false: not with 0.
  bool succeeded() {
    int status = 0;
    ::waitpid(id_, &status, 0);
    ended_ = true;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

 private:
  pid_t id_ = -1;
  std::FILE* out_ = nullptr;
  bool ended_ = false;
};

struct Count {
  int passed = 0, skipped = 0;
  std::vector<std::string> failed;
};

/// What follows a mark of Google Test's output: the test's name, up to a blank or comma.
bool marked(std::string_view line, std::string_view mark, std::string& name) {
  if (!line.starts_with(mark)) return false;
  name = std::string(line.substr(mark.size(), line.find_first_of(" ,", mark.size()) - mark.size()));
  return name.find('.') != std::string::npos;
}

/// The programs of the client's `tests/CMakeLists.txt` that want a robot; beside them lie unit tests, and servers that never end.
bool wants_robot(std::string name) {
  for (const char* suffix : {"_urcap", "_headless"})
    if (name.ends_with(suffix)) name.resize(name.size() - std::string_view(suffix).size());
  constexpr std::array known{"rtde_tests",
                             "dashboard_client_g5_tests",
                             "dashboard_client_x_tests",
                             "spline_tests",
                             "ur_driver_tests",
                             "external_control_program_tests",
                             "trajectory_streaming_tests",
                             "instruction_executor_test",
                             "instruction_executor_standalone_test",
                             "primary_client_test",
                             "ur_driver_deprecated_constructor_test"};
  return std::find(known.begin(), known.end(), name) != known.end();
}
/// Whether a program is to be run with the robot's panel (`_urcap`) or without.
Arguments of_test(const fs::path& test) {
  const std::string name = test.filename().string();
  Arguments out{test.string(), "--robot_ip", "127.0.0.1"};
  if (name.ends_with("_urcap")) out.insert(out.end(), {"--headless", "false"});
  if (name.ends_with("_headless") && !name.starts_with("primary_client"))
    out.insert(out.end(), {"--headless", "true"});
  return out;
}

void run(const fs::path& test, const std::string& sources, const Arguments& simulator, Count& count) {
  Child robot(simulator);
  std::string line, name;
  if (!robot.line(line) || !line.starts_with("ready"))
    throw std::runtime_error("the simulator does not start");
  Child child(of_test(test), sources);
  std::vector<std::string> failed;
  while (child.line(line)) {
    if (marked(line, "[       OK ] ", name)) ++count.passed;
    if (marked(line, "[  SKIPPED ] ", name)) ++count.skipped;
    if (marked(line, "[  FAILED  ] ", name) && std::find(failed.begin(), failed.end(), name) == failed.end())
      failed.push_back(name);
  }
  if (!child.succeeded() && failed.empty()) failed.push_back("ended before its tests");
  for (const auto& f : failed) count.failed.push_back(test.filename().string() + ": " + f);
}

}  // namespace

int main(int argc, char** argv) {
  const bool help = argc == 2 && std::string_view(argv[1]) == "--help";
  if (argc < 5) {
    std::fprintf(help ? stdout : stderr,
                 "usage: %s SIMULATED_UR5 FOLDER SOURCES WAIT_PROGRAM [cb3|e-series] [NAME...]\n"
                 "FOLDER has the test programs of the makers' client, SOURCES is its folder tests; "
                 "WAIT_PROGRAM is a script that waits "
                 "for ever. Without names all programs are run that want a robot.\n"
                 "Exit codes: 0 all pass, 1 some fail or none was found, 2 usage\n",
                 argv[0]);
    return help ? 0 : 2;
  }
  try {
    const std::string series = argc > 5 ? argv[5] : "e-series", wait = fs::absolute(argv[4]).string();
    const Arguments simulator{
        fs::absolute(argv[1]).string(), "--series", series, "--log", "off", "--powered", "--program",
        "wait_program.urp=" + wait};
    Count count;
    for (const auto& entry : fs::directory_iterator(fs::absolute(argv[2]))) {
      const std::string name = entry.path().filename().string();
      const bool program = entry.is_regular_file() && ::access(entry.path().c_str(), X_OK) == 0;
      const bool wanted =
          argc <= 6 ? wants_robot(name) : std::find(argv + 6, argv + argc, name) != argv + argc;
      if (program && wanted) run(entry.path(), argv[3], simulator, count);
    }
    const auto all = static_cast<std::size_t>(count.passed) + count.failed.size();
    for (const auto& f : count.failed) std::printf("failed  %s\n", f.c_str());
    std::printf("%d of %zu of the makers' tests pass, %d skip themselves\n", count.passed, all,
                count.skipped);
    return count.failed.empty() && all > 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "makers_tests: %s\n", e.what());
    return 2;
  }
}
