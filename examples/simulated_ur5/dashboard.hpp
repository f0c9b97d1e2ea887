// The dashboard server's lines, without sockets.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/controller.hpp"

namespace simulated_ur5 {

/// What the panel's users have set; one for all dashboard clients.
struct PanelState {
  std::string user_role = "PROGRAMMER";   ///< CB3
  std::string operational_mode = "NONE";  ///< e-Series: NONE until a client controls it
};

/// Programs that `load` finds: name -> URScript.
using ProgramLibrary = std::map<std::string, std::string, std::less<>>;

std::string_view name_of(RobotMode mode);
std::string_view name_of(SafetyMode mode);

/// One dashboard client.
class DashboardSession {
 public:
  static constexpr std::size_t longest_line = 1024;
  static constexpr std::string_view greeting = "Connected: Universal Robots Dashboard Server\n";

  DashboardSession(Controller& controller, const ProgramLibrary& programs, PanelState& panel)
      : controller_(controller), programs_(programs), panel_(panel) {}

  /// Takes received bytes and appends replies, one line per command. False: close the connection after
  /// sending.
  bool receive(std::span<const std::uint8_t> bytes, std::string& out);
  bool unfinished() const { return !line_.empty(); }
  /// True once a client said `shutdown`.
  bool shutdown() const { return shutdown_; }

 private:
  std::string reply(std::string_view line, bool& close);
  std::string load(std::string_view name);
  std::string loaded_name() const;
  std::string program_state() const;
  struct Command;
  static std::span<const Command> commands();

  Controller& controller_;
  const ProgramLibrary& programs_;
  PanelState& panel_;
  std::string line_;
  bool shutdown_ = false;
};

}  // namespace simulated_ur5
