// simulated_ur5: a UR5 with its controller on loopback. See README.md beside this file.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "examples/simulated_ur5/scenario.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/simulated_ur5/skin_faults.hpp"

namespace {

// Exit codes, also in the README.
constexpr int exit_ok = 0, exit_configuration = 2, exit_network = 3;

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) {
  interrupted = 1;
}

/// "host:port" with a numeric host.
void split_target(const std::string& text, simulated_ur5::Config& config) {
  const auto colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  const int number = digits ? std::stoi(port) : 0;
  if (number < 1 || number > 65535)
    throw CLI::ValidationError("--skin-target", "expected HOST:PORT or PORT, got '" + text + "'");
  if (colon != std::string::npos) config.skin_host = text.substr(0, colon);
  config.skin_port = static_cast<std::uint16_t>(number);
}

/// "5.25.1" or "5.25.1.1032100".
simulated_ur5::Version read_version(const std::string& text) {
  simulated_ur5::Version v;
  char rest = 0;
  const int parts =
      std::sscanf(text.c_str(), "%3u.%3u.%3u.%9u%c", &v.major, &v.minor, &v.bugfix, &v.build, &rest);
  if ((parts != 3 && parts != 4) || (v.major != 3 && v.major != 5))
    throw CLI::ValidationError("--polyscope", "expected 3.x.y or 5.x.y, got '" + text + "'");
  return v;
}

void load_program(const std::string& text, simulated_ur5::Config& config) {
  const auto equals = text.find('=');
  if (equals == std::string::npos)
    throw CLI::ValidationError("--program", "expected NAME=FILE, got '" + text + "'");
  std::ifstream in(text.substr(equals + 1));
  if (!in) throw CLI::ValidationError("--program", "cannot read '" + text.substr(equals + 1) + "'");
  std::ostringstream script;
  script << in.rdbuf();
  config.programs[text.substr(0, equals)] = script.str();
}

}  // namespace

int main(int argc, char** argv) {
  using simulated_ur5::LogLevel;
  simulated_ur5::Config config;

  CLI::App app{
      "A UR5 with its controller on loopback: RTDE, URScript upload, dashboard, reverse socket, skin."};
  std::string series, polyscope, scenario, skin, skin_file, key_file, faults, level = "info";
  std::vector<std::string> programs;
  app.add_option("--series", series, "cb3 (125 Hz, the default) or e-series (500 Hz)")
      ->check(CLI::IsMember({"cb3", "e-series"}));
  app.add_option("--polyscope", polyscope,
                 "version that the controller says it is, as 5.25.1; joint torques need 5.23, their friction "
                 "scales 5.25.1");
  app.add_option("--bind", config.address, "numeric address that the servers bind")->capture_default_str();
  app.add_option("--rtde-port", config.ports.rtde, "0: the system chooses")->capture_default_str();
  app.add_option("--primary-port", config.ports.primary)->capture_default_str();
  app.add_option("--secondary-port", config.ports.secondary)->capture_default_str();
  app.add_option("--realtime-port", config.ports.realtime)->capture_default_str();
  app.add_option("--dashboard-port", config.ports.dashboard)->capture_default_str();
  config.real_time = true;
  app.add_option("--speed", config.speed, "times real time; 0: lock-step, as fast as commands come")
      ->capture_default_str();
  app.add_option("--patience", config.patience, "lock-step: longest wait for a command [s]")
      ->capture_default_str();
  app.add_option("--idle-speed", config.idle_speed, "lock-step: pace while nobody commands")
      ->capture_default_str();
  app.add_option("--scenario", scenario, "TOML file with [robot], [skin] and [[touch]]")
      ->check(CLI::ExistingFile);
  app.add_option("--skin", skin_file, "skin file (JSON)")->check(CLI::ExistingFile);
  app.add_option("--skin-target", skin, "HOST:PORT that gets the skin's datagrams");
  app.add_option("--skin-key", key_file, "file with the key that seals them: 64 hex digits")
      ->check(CLI::ExistingFile);
  bool cheap = false;
  app.add_flag("--accelerometers", cheap,
               "the skin's accelerometers err as cheap ones do, and each of their measurements is sent");
  app.add_option("--skin-loss", config.skin_loss, "share of the skin's datagrams that never arrive");
  app.add_option("--skin-stop-after", config.skin_stop_after,
                 "the skin falls silent so long after the start [s]");
  app.add_option(
      "--skin-faults", faults,
      "FAULT:CELL or FAULT:SHARE%, then @SECONDS and =LEVEL if wanted, separated by commas; FAULT: "
      "stuck, saturated, blinking, noisy, cross-talk, discharge, unheard");
  auto* delay = app.add_option("--delay", config.controller.arm.delay, "pure delay of the arm [s]");
  auto* lag = app.add_option("--lag", config.controller.arm.lag, "time constant of the arm [s]");
  double stiffness = simulated_ur5::rigid;
  auto* soft =
      app.add_option("--stiffness", stiffness, "of every joint's position loop [N m/rad]; inf: rigid");
  auto* integral = app.add_option("--integral-time", config.controller.arm.integral_time,
                                  "in which the loop takes its droop back [s]; inf: it does not");
  auto* payload = app.add_option("--unknown-payload", config.controller.arm.unknown_payload,
                                 "mass at the flange of which the controller does not know [kg]");
  auto* noise = app.add_option("--noise", config.controller.arm.position_noise, "of the encoders [rad]");
  auto* seed = app.add_option("--seed", config.controller.seed, "of every noise");
  auto* force =
      app.add_option("--protective-force", config.controller.protective_force, "0: no stop on contact [N]");
  auto* powered = app.add_flag("--powered", config.controller.powered, "begin powered, brakes released");
  app.add_option("--skip-outputs", config.quirks.skipped_outputs, "share of data packages left out");
  app.add_flag("--data-before-reply", config.quirks.data_before_start_reply,
               "data overtakes the reply to start");
  app.add_flag("--reach-out", config.reach_out, "let programs open sockets to other machines");
  app.add_option("--program", programs, "NAME=FILE: a script that the dashboard's load finds");
  app.add_option("--log", level, "debug, info, warning or off")
      ->check(CLI::IsMember({"debug", "info", "warning", "off"}))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
    if (!scenario.empty()) {
      // What the command line says overrides the scenario.
      simulated_ur5::Config from_file = config;
      from_file.controller = {};
      simulated_ur5::read_scenario(scenario, from_file);
      const auto given = config.controller;
      config.controller = from_file.controller;
      if (*delay) config.controller.arm.delay = given.arm.delay;
      if (*lag) config.controller.arm.lag = given.arm.lag;
      if (*integral) config.controller.arm.integral_time = given.arm.integral_time;
      if (*payload) config.controller.arm.unknown_payload = given.arm.unknown_payload;
      if (*noise) config.controller.arm.position_noise = given.arm.position_noise;
      if (*seed) config.controller.seed = given.seed;
      if (*force) config.controller.protective_force = given.protective_force;
      if (*powered) config.controller.powered = given.powered;
    }
    if (*soft) config.controller.arm.stiffness.fill(stiffness);
    if (!series.empty())
      config.controller.series =
          series == "cb3" ? simulated_ur5::Series::cb3 : simulated_ur5::Series::e_series;
    if (!polyscope.empty()) config.controller.version = read_version(polyscope);
    if (!skin_file.empty()) config.controller.cells = simulated_ur5::read_skin_cells(skin_file);
    if (cheap) simulated_ur5::err_as_cheap_ones(config.controller.skin);
    if (!key_file.empty()) config.skin_key = adapters::skin::Key::read(key_file);
    if (!skin.empty()) split_target(skin, config);
    if (!faults.empty())
      config.controller.skin.faults =
          simulated_ur5::read_skin_faults(faults, config.controller.cells, config.controller.seed);
    for (const std::string& program : programs) load_program(program, config);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? exit_ok : exit_configuration;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "simulated_ur5: %s\n", e.what());
    return exit_configuration;
  }

  auto logger = spdlog::stderr_color_mt("simulated_ur5");
  logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  logger->set_level(level == "off"       ? spdlog::level::off
                    : level == "warning" ? spdlog::level::warn
                    : level == "debug"   ? spdlog::level::debug
                                         : spdlog::level::info);
  config.log = [&](LogLevel l, const std::string& text) {
    logger->log(l == LogLevel::warning ? spdlog::level::warn
                : l == LogLevel::info  ? spdlog::level::info
                                       : spdlog::level::debug,
                "{}", text);
  };

  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  std::unique_ptr<simulated_ur5::SimulatedUr5> robot;
  try {
    robot = std::make_unique<simulated_ur5::SimulatedUr5>(config);
    robot->start();
  } catch (const std::invalid_argument& e) {
    std::fprintf(stderr, "simulated_ur5: %s\n", e.what());
    return exit_configuration;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "simulated_ur5: %s\n", e.what());
    return exit_network;
  }
  // A parent process reads this line, then connects.
  const auto ports = robot->ports();
  std::printf("ready rtde=%u primary=%u secondary=%u dashboard=%u realtime=%u\n", unsigned{ports.rtde},
              unsigned{ports.primary}, unsigned{ports.secondary}, unsigned{ports.dashboard},
              unsigned{ports.realtime});
  std::fflush(stdout);

  while (!robot->wait(0.1))
    if (interrupted != 0) break;
  const simulated_ur5::Snapshot last = robot->snapshot();
  robot->stop();
  for (const auto& touch : last.touches) {
    if (!touch.began) continue;
    std::printf("touch \"%s\" link=%zu cell=%u peak_force=%.2fN at=%.3fs deflection=%.1fmm impulse=%.2fNs\n",
                touch.name.c_str(), touch.link, touch.cell, touch.peak_force, touch.peak_force_time,
                1000 * touch.peak_deflection, touch.impulse);
  }
  std::printf("stopped after %.3f s of simulated time, %llu protective stops\n", last.state.timestamp,
              static_cast<unsigned long long>(last.counters.protective_stops));
  return exit_ok;
}
