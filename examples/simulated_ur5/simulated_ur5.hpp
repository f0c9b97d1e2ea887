// A UR5 with its controller on the network: RTDE, script upload, dashboard, reverse socket and skin, on a
// thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "examples/adapters/skin/authentication.hpp"
#include "examples/adapters/skin/lights.hpp"
#include "examples/simulated_ur5/controller.hpp"
#include "examples/simulated_ur5/dashboard.hpp"
#include "examples/simulated_ur5/rtde_session.hpp"

namespace simulated_ur5 {

/// TCP ports; 0 lets the system choose.
struct Ports {
  std::uint16_t dashboard = 29999;
  std::uint16_t primary = 30001;
  std::uint16_t secondary = 30002;
  std::uint16_t rtde = 30004;
  std::uint16_t realtime = 30003;
};

enum class LogLevel { debug, info, warning };

struct Config {
  ControllerConfig controller;
  std::string address = "127.0.0.1";  ///< numeric address that all servers bind
  Ports ports;
  /// 1: real time. K: K times faster, by the clock; clients must keep up. 0: lock-step, as fast as commands
  /// come. While a program reads commands, simulated time stands still after each data package to the client
  /// that started its stream first, until a message comes on the reverse socket. Without such a program, or
  /// nobody to send data to, time passes at `idle_speed`.
  double speed = 1;
  double idle_speed = 1;
  bool real_time = false;  ///< its thread asks for the priority of a control loop, if it goes by the clock
  /// Lock-step: how long an answer may take [s of real time]. Then simulated time goes on at `idle_speed`, so
  /// that the program's own read timeout decides, until the next message.
  double patience = 1;
  std::string skin_host = "127.0.0.1";          ///< numeric address that gets the skin's datagrams
  std::uint16_t skin_port = 0;                  ///< 0: nobody gets them
  std::optional<adapters::skin::Key> skin_key;  ///< the datagrams are sealed with it
  double skin_loss = 0;                         ///< share of its datagrams that never arrive
  double skin_stop_after = 0;  ///< the skin falls silent this long after the scenario's start [s]; 0: never
  /// Whether programs may make the robot connect to other addresses than this machine's own loopback.
  bool reach_out = false;
  /// A client whose message or program stays unfinished so long is closed [s of real time].
  double unfinished_time = 10;
  rtde::Quirks quirks;
  ProgramLibrary programs;                                ///< what the dashboard's `load` finds
  std::function<void(LogLevel, const std::string&)> log;  ///< called on the simulator's thread
};
/// Throws `skinctl::ConfigurationError`.
void check(const Config& config);

/// What the simulated world knows at the end of a cycle; a real robot could not tell all of it.
struct Snapshot {
  RobotState state;
  Joints true_q{}, true_dq{};
  Counters counters;
  std::vector<TouchResult> touches;
  double scenario_time = -1;
  double contact_force = 0;  ///< largest of the fingers now [N]
  std::uint64_t skin_datagrams = 0, skin_samples = 0;
  double behind =
      0;  ///< farthest behind the clock since the scenario's start, where this computer is busy [s]
};

/// Runs a `Controller` behind its protocols on a thread of its own. Thread-safe unless said otherwise.
class SimulatedUr5 {
 public:
  explicit SimulatedUr5(Config config);
  ~SimulatedUr5();
  SimulatedUr5(const SimulatedUr5&) = delete;
  SimulatedUr5& operator=(const SimulatedUr5&) = delete;

  /// Binds the ports and starts the thread; once. Throws `std::runtime_error` when a port cannot be bound.
  void start();
  /// Closes everything and joins the thread; does nothing when already stopped.
  void stop();
  /// Blocks until a client says `shutdown` or another thread calls `stop`, at most `seconds`; true if it has
  /// ended.
  bool wait(double seconds);

  /// The ports in use; valid after `start`.
  Ports ports() const;
  Snapshot snapshot();
  /// Runs `f` between two cycles and waits for it.
  void call(const std::function<void(Controller&)>& f);
  /// Where the skin's datagrams go from now on; port 0: nowhere. Throws `skinctl::ConfigurationError` for a
  /// host that is no numeric address.
  void set_skin_target(const std::string& host, std::uint16_t port);
  /// The lights of the skin's cells, as the receiver of its datagrams wanted them last.
  adapters::skin::Picture lights();
  /// False: the skin falls silent.
  void set_skin_stream(bool on);

 private:
  class Network;
  std::unique_ptr<Network> network_;
};

}  // namespace simulated_ur5
