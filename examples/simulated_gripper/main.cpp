// simulated_gripper: a gripper's controller on loopback. See README.md beside this file.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <thread>

#include "examples/simulated_gripper/server.hpp"
#include "examples/support/program.hpp"

namespace {
constexpr int exit_ok = 0, exit_network = 3;
volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) {
  interrupted = 1;
}
}  // namespace

int main(int argc, char** argv) {
  using simulated_gripper::Kind;
  simulated_gripper::ServerConfig config;
  CLI::App app{"A gripper and its controller on loopback, closing on an object if there is one."};
  std::string kind;
  double seconds = 0;
  app.add_option("kind", kind,
                 "robotiq (2F-85, text lines), onrobot (RG2, Modbus TCP) or lacquey (connects to --port)")
      ->required()
      ->check(CLI::IsMember({"robotiq", "onrobot", "lacquey"}));
  app.add_option("--bind", config.address,
                 "numeric address that it serves at; for lacquey that it connects to")
      ->capture_default_str();
  app.add_option("--port", config.port, "0: the system chooses; those of real ones: 63352, 502, 50003")
      ->capture_default_str();
  app.add_option("--object", config.object.width, "width of what is between the fingers; 0: nothing [m]")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--stiffness", config.object.stiffness, "of the object; inf: rigid [N/m]")
      ->check(CLI::PositiveNumber);
  app.add_option("--speed", config.speed, "times real time")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  app.add_flag("--active", config.active, "a Robotiq that was activated before");
  app.add_option("--seconds", seconds, "ends after so long; 0: at a signal [s]")
      ->check(CLI::NonNegativeNumber);
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  config.kind = kind == "robotiq" ? Kind::robotiq : kind == "onrobot" ? Kind::onrobot : Kind::lacquey;
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  try {
    simulated_gripper::Server server(config);
    std::printf("ready port=%u\n", unsigned{server.port()});  // a parent process reads this line
    std::fflush(stdout);
    const auto start = std::chrono::steady_clock::now();
    while (interrupted == 0 && (seconds <= 0 || std::chrono::steady_clock::now() - start <
                                                    std::chrono::duration<double>(seconds)))
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const auto seen = server.seen();
    std::printf("stopped %.1f mm open, pushing with %.1f N\n", 1000 * seen.opening, seen.force);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "simulated_gripper: %s\n", e.what());
    return exit_network;
  }
  return exit_ok;
}
