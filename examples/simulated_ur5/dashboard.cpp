#include "examples/simulated_ur5/dashboard.hpp"

#include <cctype>
#include <optional>

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

/// A line of the guide: `word`, alone or with an argument behind it.
struct DashboardSession::Command {
  std::string_view word;
  enum { both, cb3, e_series } since;
  bool argument;
  std::string (*answer)(DashboardSession&, std::string_view argument);
};

namespace {

constexpr std::string_view roles[] = {"PROGRAMMER", "OPERATOR", "NONE", "LOCKED", "RESTRICTED"};
constexpr std::string_view operational_modes[] = {"MANUAL", "AUTOMATIC"};

/// The one of `words` that `text` is, capitals or not.
template <std::size_t N>
std::optional<std::string> one_of(const std::string_view (&words)[N], std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string_view w : words)
    if (w == upper) return upper;
  return std::nullopt;
}

}  // namespace

std::string DashboardSession::loaded_name() const {
  const std::string& name = controller_.loaded_name();
  return name.empty() ? "<unnamed>" : name.substr(name.rfind('/') + 1);
}

std::string DashboardSession::program_state() const {
  switch (controller_.state().runtime_state) {
    case RuntimeState::stopped:
    case RuntimeState::stopping:
      return "STOPPED";
    case RuntimeState::paused:
    case RuntimeState::pausing:
      return "PAUSED";
    default:
      return "PLAYING";
  }
}

std::string DashboardSession::load(std::string_view name) {
  // By its whole path, else by the file's name.
  auto found = programs_.find(name);
  if (found == programs_.end()) found = programs_.find(name.substr(name.rfind('/') + 1));
  if (found == programs_.end()) return "File not found: " + printable(name);
  controller_.stop_program();
  controller_.load(std::string(name), found->second);
  return "Loading program: " + printable(name);
}

// Empty: the controller is in no state for it.
std::span<const DashboardSession::Command> DashboardSession::commands() {
  using S = DashboardSession;
  using Text = std::string;
  using View = std::string_view;
  static constexpr Command table[] = {
      {"power on", Command::both, false,
       [](S& s, View) -> Text { return s.controller_.power_on() ? "Powering on" : ""; }},
      {"power off", Command::both, false,
       [](S& s, View) -> Text {
         s.controller_.power_off();
         return "Powering off";
       }},
      {"brake release", Command::both, false,
       [](S& s, View) -> Text { return s.controller_.brake_release() ? "Brake releasing" : ""; }},
      {"play", Command::both, false,
       [](S& s, View) -> Text { return s.controller_.play() ? "Starting program" : ""; }},
      {"stop", Command::both, false,
       [](S& s, View) -> Text { return s.controller_.stop_program() ? "Stopped" : ""; }},
      {"pause", Command::both, false,
       [](S& s, View) -> Text { return s.controller_.pause() ? "Pausing program" : ""; }},
      {"robotmode", Command::both, false,
       [](S& s, View) -> Text { return "Robotmode: " + Text(name_of(s.controller_.state().robot_mode)); }},
      {"safetymode", Command::both, false,
       [](S& s, View) -> Text { return "Safetymode: " + Text(name_of(s.controller_.state().safety_mode)); }},
      {"safetystatus", Command::both, false,
       [](S& s, View) -> Text {
         return "Safetystatus: " + Text(name_of(s.controller_.state().safety_mode));
       }},
      {"running", Command::both, false,
       [](S& s, View) -> Text {
         const auto state = s.controller_.state().runtime_state;
         const bool runs = state == RuntimeState::playing || state == RuntimeState::resuming ||
                           state == RuntimeState::pausing;
         return Text("Program running: ") + (runs ? "true" : "false");
       }},
      {"programState", Command::both, false,
       [](S& s, View) -> Text { return s.program_state() + " " + s.loaded_name(); }},
      {"unlock protective stop", Command::both, false,
       [](S& s, View) -> Text {
         return s.controller_.unlock_protective_stop() ? "Protective stop releasing"
                                                       : "Cannot unlock protective stop until 5s after "
                                                         "occurrence. Always inspect cause of protective "
                                                         "stop before unlocking";
       }},
      {"close safety popup", Command::both, false,
       [](S& s, View) -> Text {
         s.controller_.close_popup();
         return "closing safety popup";
       }},
      {"close popup", Command::both, false,
       [](S& s, View) -> Text {
         s.controller_.close_popup();
         return "closing popup";
       }},
      {"popup", Command::both, true,
       [](S& s, View) -> Text {
         s.controller_.show_popup();
         return "showing popup";
       }},
      {"restart safety", Command::both, false,
       [](S& s, View) -> Text {
         s.controller_.restart_safety();
         return "Restarting safety";
       }},
      {"load installation", Command::both, true,
       [](S&, View name) -> Text { return "Loading installation: " + printable(name); }},
      {"load", Command::both, true, [](S& s, View name) -> Text { return s.load(name); }},
      {"get loaded program", Command::both, false,
       [](S& s, View) -> Text {
         const Text& name = s.controller_.loaded_name();
         return name.empty() ? "No program loaded" : "Loaded program: " + name;
       }},
      {"isProgramSaved", Command::both, false, [](S& s, View) -> Text { return "true " + s.loaded_name(); }},
      {"addToLog", Command::both, true,
       [](S& s, View text) -> Text {
         if (s.controller_.on_message) s.controller_.on_message("Log: " + printable(text));
         return "Added log message";
       }},
      {"saveLog", Command::both, false, [](S&, View) -> Text { return "Log saved to disk"; }},
      {"generate flight report", Command::both, true,
       [](S& s, View) -> Text {
         return "Flight Report generated with id: " + std::to_string(s.controller_.now() / 1'000'000);
       }},
      {"generate support file", Command::both, true,
       [](S&, View folder) -> Text {
         return "Completed successfully: " + printable(folder) + "/support.zip";
       }},
      {"PolyscopeVersion", Command::both, false,
       [](S& s, View) -> Text {
         const Version v = s.controller_.version();
         return "URSoftware " + dotted(v) + (v.major >= 5 ? " (Dec 05 2022)" : " (Mar 14 2023)");
       }},
      {"version", Command::e_series, false,
       [](S& s, View) -> Text { return dotted(s.controller_.version()); }},
      {"get robot model", Command::both, false, [](S&, View) -> Text { return "UR5"; }},
      {"get serial number", Command::both, false,
       [](S& s, View) -> Text {
         return s.controller_.config().series == Series::e_series ? "20185500001" : "2015350001";
       }},
      {"is in remote control", Command::e_series, false, [](S&, View) -> Text { return "true"; }},
      {"get operational mode", Command::e_series, false,
       [](S& s, View) -> Text { return s.panel_.operational_mode; }},
      {"set operational mode", Command::e_series, true,
       [](S& s, View mode) -> Text {
         const auto known = one_of(operational_modes, mode);
         if (!known) return "";
         s.panel_.operational_mode = *known;
         return "Operational mode " + printable(mode) + " is set";
       }},
      {"clear operational mode", Command::e_series, false,
       [](S& s, View) -> Text {
         s.panel_.operational_mode = "NONE";
         return "No longer controlling the operational mode. Current operational mode: 'NONE'.";
       }},
      {"setUserRole", Command::cb3, true,
       [](S& s, View role) -> Text {
         const auto known = one_of(roles, role);
         if (!known) return "Failed setting user role: " + printable(role);
         s.panel_.user_role = *known;
         return "Setting user role: " + printable(role);
       }},
      {"getUserRole", Command::cb3, false, [](S& s, View) -> Text { return s.panel_.user_role; }},
      {"quit", Command::both, false, [](S&, View) -> Text { return "Disconnected"; }},
      {"shutdown", Command::both, false,
       [](S& s, View) -> Text {
         s.shutdown_ = true;
         return "Shutting down";
       }},
  };
  return table;
}

std::string DashboardSession::reply(std::string_view line, bool& close) {
  const bool e_series = controller_.config().series == Series::e_series;
  for (const Command& c : commands()) {
    const bool alone = line == c.word;
    const bool with =
        c.argument && line.size() > c.word.size() && line.starts_with(c.word) && line[c.word.size()] == ' ';
    if (!alone && !with) continue;
    if (c.since != Command::both && (c.since == Command::e_series) != e_series) continue;
    const std::string answer = c.answer(*this, trimmed(line.substr(c.word.size())));
    close = c.word == "quit" || c.word == "shutdown";
    return answer.empty() ? "Failed to execute: " + printable(line) : answer;
  }
  return "could not understand: '" + printable(line) + "'";
}

}  // namespace simulated_ur5
