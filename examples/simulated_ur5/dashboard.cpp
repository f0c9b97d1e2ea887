#include "examples/simulated_ur5/dashboard.hpp"

#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5 {
namespace {

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t' || s.back() == '\r')) s.remove_suffix(1);
  return s;
}

std::string printable(std::string_view s) {
  std::string out(s);
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return out;
}

}  // namespace

std::string_view name_of(RobotMode mode) {
  switch (mode) {
    case RobotMode::no_controller:
      return "NO_CONTROLLER";
    case RobotMode::disconnected:
      return "DISCONNECTED";
    case RobotMode::confirm_safety:
      return "CONFIRM_SAFETY";
    case RobotMode::booting:
      return "BOOTING";
    case RobotMode::power_off:
      return "POWER_OFF";
    case RobotMode::power_on:
      return "POWER_ON";
    case RobotMode::idle:
      return "IDLE";
    case RobotMode::backdrive:
      return "BACKDRIVE";
    case RobotMode::running:
      return "RUNNING";
    case RobotMode::updating:
      return "UPDATING";
  }
  return "DISCONNECTED";
}

std::string_view name_of(SafetyMode mode) {
  switch (mode) {
    case SafetyMode::normal:
      return "NORMAL";
    case SafetyMode::reduced:
      return "REDUCED";
    case SafetyMode::protective_stop:
      return "PROTECTIVE_STOP";
    case SafetyMode::recovery:
      return "RECOVERY";
    case SafetyMode::safeguard_stop:
      return "SAFEGUARD_STOP";
    case SafetyMode::system_emergency_stop:
      return "SYSTEM_EMERGENCY_STOP";
    case SafetyMode::robot_emergency_stop:
      return "ROBOT_EMERGENCY_STOP";
    case SafetyMode::violation:
      return "VIOLATION";
    case SafetyMode::fault:
      return "FAULT";
  }
  return "FAULT";
}

bool DashboardSession::receive(std::span<const std::uint8_t> bytes, std::string& out) {
  for (const std::uint8_t b : bytes) {
    if (b != '\n') {
      if (line_.size() >= longest_line) {
        out += "could not understand: a line of more than 1024 characters\n";
        return false;
      }
      line_.push_back(static_cast<char>(b));
      continue;
    }
    bool close = false;
    out += reply(trimmed(line_), close);
    out += '\n';
    line_.clear();
    if (close) return false;
    if (out.size() > 64 * longest_line) return false;  // more questions at once than a client may ask
  }
  return true;
}

std::string DashboardSession::reply(std::string_view line, bool& close) {
  const RobotState& s = controller_.state();
  const auto argument = [&](std::string_view command) { return trimmed(line.substr(command.size())); };
  const auto failed = [&] { return "Failed to execute: " + printable(line); };
  const auto program = [&] {
    return controller_.loaded_name().empty() ? std::string("<unnamed>") : controller_.loaded_name();
  };
  const bool e_series = controller_.config().series == Series::e_series;

  if (line == "power on") return controller_.power_on() ? "Powering on" : failed();
  if (line == "power off") {
    controller_.power_off();
    return "Powering off";
  }
  if (line == "brake release") return controller_.brake_release() ? "Brake releasing" : failed();
  if (line == "play") return controller_.play() ? "Starting program" : failed();
  if (line == "stop") return controller_.stop_program() ? "Stopped" : failed();
  if (line == "pause") return controller_.pause() ? "Pausing program" : failed();
  if (line == "robotmode") return "Robotmode: " + std::string(name_of(s.robot_mode));
  if (line == "safetymode") return "Safetymode: " + std::string(name_of(s.safety_mode));
  if (line == "safetystatus") return "Safetystatus: " + std::string(name_of(s.safety_mode));
  if (line == "running") return std::string("Program running: ") + (s.program_running ? "true" : "false");
  if (line == "programState") {
    const char* state = s.runtime_state == RuntimeState::stopped    ? "STOPPED "
                        : s.runtime_state == RuntimeState::stopping ? "STOPPED "
                        : s.runtime_state == RuntimeState::paused   ? "PAUSED "
                        : s.runtime_state == RuntimeState::pausing  ? "PAUSED "
                                                                    : "PLAYING ";
    return state + program();
  }
  if (line == "unlock protective stop")
    return controller_.unlock_protective_stop() ? "Protective stop releasing"
                                                : "Cannot unlock protective stop until 5s after occurrence. "
                                                  "Always inspect cause of protective stop "
                                                  "before unlocking";
  if (line == "close safety popup") {
    controller_.close_popup();
    return "closing safety popup";
  }
  if (line == "close popup") {
    controller_.close_popup();
    return "closing popup";
  }
  if (line.starts_with("popup ")) {
    controller_.show_popup();
    return "showing popup";
  }
  if (line == "restart safety") {
    controller_.restart_safety();
    return "Restarting safety";
  }
  if (line.starts_with("load installation "))
    return "Loading installation: " + printable(argument("load installation "));
  if (line.starts_with("load ")) {
    const std::string_view name = argument("load ");
    const auto found = programs_.find(name);
    if (found == programs_.end()) return "File not found: " + printable(name);
    controller_.stop_program();
    controller_.load(found->first, found->second);
    return "Loading program: " + printable(name);
  }
  if (line == "get loaded program")
    return controller_.loaded_name().empty() ? "No program loaded"
                                             : "Loaded program: " + controller_.loaded_name();
  if (line == "isProgramSaved") return "true " + program();
  if (line.starts_with("addToLog ")) {
    if (controller_.on_message) controller_.on_message("Log: " + printable(argument("addToLog ")));
    return "Added log message";
  }
  const Version version = controller_.version();
  if (line == "PolyscopeVersion")
    return "URSoftware " + dotted(version) + (e_series ? " (Dec 05 2022)" : " (Mar 14 2023)");
  if (line == "version" && e_series) return dotted(version);
  if (line == "get robot model") return "UR5";
  if (line == "get serial number") return e_series ? "20185500001" : "2015350001";
  if (line == "is in remote control" && e_series) return "true";
  if (line == "get operational mode" && e_series) return "NONE";
  if (line == "quit") {
    close = true;
    return "Disconnected";
  }
  if (line == "shutdown") {
    close = true;
    shutdown_ = true;
    return "Shutting down";
  }
  return "could not understand: '" + printable(line) + "'";
}

}  // namespace simulated_ur5
