#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>

#include <csignal>
#include <string>
#include <vector>

#include "examples/simulated_ur5/tests/raw.hpp"

namespace {

/// The program as a child, with its output in a pipe.
class Child {
 public:
  explicit Child(std::vector<std::string> arguments) {
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    id_ = ::fork();
    REQUIRE(id_ >= 0);
    if (id_ == 0) {
      ::dup2(ends[1], 1);
      ::dup2(ends[1], 2);
      ::close(ends[0]);
      ::close(ends[1]);
      std::vector<char*> argv{const_cast<char*>(SIMULATED_UR5_PROGRAM)};
      for (std::string& a : arguments) argv.push_back(a.data());
      argv.push_back(nullptr);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    out_ = ends[0];
  }
  ~Child() {
    if (id_ > 0) {
      ::kill(id_, SIGKILL);
      ::waitpid(id_, nullptr, 0);
    }
    ::close(out_);
  }
  std::string line() {
    std::string text;
    pollfd p{out_, POLLIN, 0};
    for (char c = 0; ::poll(&p, 1, 10000) > 0 && ::read(out_, &c, 1) == 1 && c != '\n';) text.push_back(c);
    return text;
  }
  std::string rest() {
    std::string text;
    for (char c = 0; ::read(out_, &c, 1) == 1;) text.push_back(c);
    return text;
  }
  void signal(int number) const { ::kill(id_, number); }
  int exit_code() {
    int status = 0;
    ::waitpid(id_, &status, 0);
    id_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t id_ = -1;
  int out_ = -1;
};

std::uint16_t port_of(const std::string& ready, const std::string& name) {
  const auto at = ready.find(name + "=");
  REQUIRE(at != std::string::npos);
  return static_cast<std::uint16_t>(std::stoi(ready.substr(at + name.size() + 1)));
}

const std::vector<std::string> any_ports{
    "--rtde-port",     "0", "--primary-port", "0",  "--secondary-port", "0", "--dashboard-port", "0",
    "--realtime-port", "0", "--log",          "off"};

std::vector<std::string> with(std::vector<std::string> more) {
  std::vector<std::string> all = any_ports;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("Program: says its ports, serves, and ends cleanly on SIGINT and SIGTERM") {
  for (const int number : {SIGINT, SIGTERM}) {
    Child child(with({"--powered", "--series", "e-series", "--speed", "2"}));
    const std::string ready = child.line();
    CHECK(ready.find("ready rtde=") == 0);
    raw::Tcp rtde = raw::rtde_client(port_of(ready, "rtde"), 500, "timestamp,robot_mode");
    raw::start(rtde);
    CHECK(raw::take(raw::read_until(rtde, 'U').payload, 9, 4) == 7);
    child.signal(number);
    CHECK(rtde.closes());
    CHECK(child.rest().find("stopped after") != std::string::npos);
    CHECK(child.exit_code() == 0);
  }
}

TEST_CASE("Program: a dashboard shutdown ends it with 0") {
  Child child(any_ports);
  raw::Tcp dashboard(port_of(child.line(), "dashboard"));
  dashboard.line();
  dashboard.send("shutdown\n");
  CHECK(dashboard.line() == "Shutting down");
  child.rest();
  CHECK(child.exit_code() == 0);
}

TEST_CASE("Program: exit codes tell a wrong configuration from a taken port") {
  CHECK(Child({"--help"}).exit_code() == 0);
  CHECK(Child({"--no-such-option"}).exit_code() == 2);
  CHECK(Child({"--series", "ur10"}).exit_code() == 2);
  CHECK(Child(with({"--delay", "-1"})).exit_code() == 2);
  CHECK(Child(with({"--bind", "nowhere"})).exit_code() == 2);
  CHECK(Child(with({"--skin-target", "127.0.0.1:99999"})).exit_code() == 2);
  CHECK(Child(with({"--program", "x"})).exit_code() == 2);
  Child first(any_ports);
  const std::string taken = std::to_string(port_of(first.line(), "rtde"));
  Child second({"--rtde-port", taken, "--primary-port", "0", "--secondary-port", "0", "--dashboard-port", "0",
                "--realtime-port", "0"});
  CHECK(second.line().find("cannot listen") != std::string::npos);
  CHECK(second.exit_code() == 3);
}

TEST_SUITE_END();
