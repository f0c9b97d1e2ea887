// Drives a UR5, real or simulated: states by RTDE, commands over the reverse socket of a small URScript
// program.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "examples/adapters/socket.hpp"
#include "examples/adapters/ur5/rtde.hpp"
#include "skinctl/hardware/robot.hpp"

namespace adapters::ur5 {

/// `lookahead_time` of the program's servoj, the least there is [s]: by position the arm comes behind its
/// commands by a lag of that beside the drive's own, by velocity it does not.
inline constexpr double servoj_lookahead = 0.03;

/// Where the robot is, and how to talk to it.
struct DriverConfig {
  std::string host = "127.0.0.1";
  std::uint16_t rtde_port = 30004;
  std::uint16_t script_port = 30002;
  std::uint16_t dashboard_port = 29999;
  std::uint16_t reverse_port = 0;  ///< on this computer; 0: any
  std::string reverse_address;     ///< address of this computer that the robot can reach; empty: find out
  double rate = 125;               ///< of states and commands: 125 on CB3, up to 500 on e-Series [1/s]
  skinctl::Interface interface = skinctl::Interface::position;
  bool power_up = true;  ///< switch the arm on and release its brakes by the dashboard
  Timeout connect_timeout{5000};
  Timeout silence{40};          ///< without a state for so long: a cycle on the last one
  Timeout give_up{500};         ///< without a state for so long: lost
  Timeout robot_patience{100};  ///< without a command for so long the robot stops by itself
};

/// A `RobotDriver` for six joints. Everything that can fail before the loop throws `ConnectionError`; in the
/// loop the reason is kept in `error()`.
///
/// The robot runs our own program (see `program()`): it connects back and obeys each message for at most
/// `robot_patience`; then it stops with `stopj`, whatever has become of this computer.
class Driver {
 public:
  explicit Driver(const DriverConfig& config);
  ~Driver();
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// Connects, powers up, subscribes, uploads the program and waits until the robot has connected back.
  void connect();

  skinctl::Heard wait(skinctl::State<6>& state) noexcept;
  bool send(const skinctl::JointCommand<6>& command) noexcept;
  void stop() noexcept;
  /// Where the arm was told to be at the newest report: a droop or an offset of the encoders lies between this
  /// and the measured position.
  [[nodiscard]] skinctl::JointPosition<6> told() const noexcept {
    return skinctl::JointPosition<6>(report_.told);
  }

  /// Why the robot was lost; empty while it is there.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  /// The newest report of the robot.
  [[nodiscard]] const Report& report() const noexcept { return report_; }
  /// The robot's clock at the newest report, in whole microseconds.
  [[nodiscard]] skinctl::Nanoseconds clock() const noexcept;
  /// Version of the controller, as it says.
  [[nodiscard]] const std::string& controller() const noexcept { return controller_; }
  /// Packages that said nothing we could use.
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return nonsense_; }

  /// The URScript program for an arm at `rate` that connects to `address:port`.
  [[nodiscard]] static std::string program(const std::string& address, std::uint16_t port, double rate);
  /// The message of the reverse socket: read timeout [ms], six numbers in millionths, mode.
  [[nodiscard]] static std::array<std::uint8_t, 32> message(std::int32_t timeout_ms,
                                                            const std::array<double, 6>& values,
                                                            std::int32_t mode) noexcept;

 private:
  void power_up();
  void negotiate();
  void upload();
  std::string ask(const std::string& line);
  Package expect(std::uint8_t type, const char* what);
  /// Reads until a package is there; false when the time is over or the stream is lost (`error_` says which).
  bool read_package(Package& package, Timeout timeout) noexcept;
  skinctl::Heard fail(const std::string& what) noexcept;

  DriverConfig config_;
  boost::asio::io_context io_;
  Stream rtde_, dashboard_, script_, reverse_;
  Framer framer_;
  std::uint8_t recipe_ = 0;
  Report report_;
  std::string controller_, error_, dashboard_rest_;
  std::uint64_t nonsense_ = 0;
  bool running_ = false;
  bool silent_ = false;  ///< the last wait ended without a state
};

}  // namespace adapters::ur5
