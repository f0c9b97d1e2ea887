// Drives a UR5, real or simulated: states by RTDE, commands over the reverse socket of a small URScript
// program.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "examples/adapters/socket.hpp"
#include "examples/adapters/ur5/fault.hpp"
#include "examples/adapters/ur5/program.hpp"
#include "examples/adapters/ur5/rtde_client.hpp"
#include "skinctl/hardware/robot.hpp"

namespace adapters::ur5 {

/// How power and brakes are reached.
enum class PanelKind : unsigned char {
  automatic,  ///< by the controller's version: REST with PolyScope X, else the dashboard
  dashboard,
  rest
};

/// What is asked of the motors besides the state.
enum class MotorOutput : unsigned char {
  none,
  current,  ///< actual_current [A]
  torque    ///< actual_current_as_torque [N m] of a controller that has it, else actual_current
};

/// Where the robot is, and how to talk to it.
struct DriverConfig {
  std::string host = "127.0.0.1";
  std::uint16_t rtde_port = 30004;
  std::uint16_t script_port = 30002;
  std::uint16_t dashboard_port = 29999;
  std::uint16_t rest_port = 80;
  std::uint16_t reverse_port = 0;  ///< on this computer; 0: any
  std::string reverse_address;     ///< address of this computer that the robot can reach; empty: find out
  std::uint16_t told_port = 0;  ///< that the robot is told, where another one is forwarded here; 0: the same
  double rate = 125;            ///< of states and commands: 125 on CB3, up to 500 on e-Series [1/s]
  skinctl::Interface interface = skinctl::Interface::position;
  PanelKind panel = PanelKind::automatic;
  bool tool = false;  ///< the pose of the tool's point is asked for, too
  MotorOutput motors = MotorOutput::none;
  bool echo = false;     ///< the program on the robot echoes its messages: see `Driver::round_trip`
  bool power_up = true;  ///< switch the arm on and release its brakes
  bool unlock = false;   ///< the user's consent to release a protective stop while connecting
  TorqueSettings torque{};
  Timeout connect_timeout{5000};
  /// Without a state for so long: as many cycles on the last one, then another one each period, so that the
  /// robot's program does not end while the loop brakes and holds.
  Timeout silence{40};
  Timeout give_up{500};         ///< without a state for so long: lost
  Timeout robot_patience{100};  ///< without a command for so long the robot stops by itself
  bool real_time = true;        ///< false: a simulation whose clock need not agree with this computer's
};

/// A `RobotDriver` for six joints. Everything that can fail before the loop throws `ConnectionError`; in the
/// loop the reason is kept in `fault()` and `error()`: see fault.hpp.
///
/// The robot runs our own program (see program.hpp): it connects back and obeys each message for at most
/// `robot_patience`; then it stops with `stopj`, whatever has become of this computer. A command of which
/// nothing was heard TCP sends again after a tenth of that, and after another, where the kernel lets a
/// socket choose: else it takes 200 ms to find that one was lost twice.
class Driver {
 public:
  /// Throws `ConfigurationError`.
  explicit Driver(const DriverConfig& config);
  ~Driver();
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// Connects, powers up, subscribes, uploads the program and waits until the robot has connected back. After
  /// a loss it may be called again, which is the user's consent to go on.
  void connect();

  skinctl::Heard wait(skinctl::State<6>& state) noexcept;
  /// A command of the interface that the configuration names; false for another.
  bool send(const skinctl::PositionCommand<6>& c) noexcept {
    return send(skinctl::Interface::position, c.position.data);
  }
  bool send(const skinctl::VelocityCommand<6>& c) noexcept {
    return send(skinctl::Interface::velocity, c.velocity.data);
  }
  bool send(const skinctl::TorqueCommand<6>& c) noexcept {
    return send(skinctl::Interface::torque, c.torque.data);
  }
  /// A message without a command: the program on the robot stops the arm (`stopj`) and holds it until the
  /// next one.
  bool hold() noexcept;
  void stop() noexcept;
  /// Time from sending a message until a state came that shows it as read, of the newest such message, by
  /// this computer's clock [s]; negative: not known, as `DriverConfig::echo` is off, the controller is older
  /// than 3.9 or 5.3, or time is not real.
  [[nodiscard]] double round_trip() const noexcept { return round_trip_; }
  /// Where the arm was told to be at the newest report: a droop or an offset of the encoders lies between
  /// this and the measured position.
  [[nodiscard]] skinctl::JointPosition<6> told() const noexcept {
    return skinctl::JointPosition<6>(report_.told);
  }

  /// Why the robot was lost.
  [[nodiscard]] Fault fault() const noexcept { return fault_; }
  /// The same in words; empty while it is there.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  /// The newest report of the robot.
  [[nodiscard]] const Report& report() const noexcept { return report_; }
  /// Whether `report().motors` are torques at the joints [N m], not currents [A].
  [[nodiscard]] bool motors_in_newton_metres() const noexcept {
    return config_.motors == MotorOutput::torque && rtde_.version().takes_torques();
  }
  /// The robot's clock at the newest report, in whole microseconds, and a period later for each wait since
  /// that ended without one.
  [[nodiscard]] skinctl::Nanoseconds clock() const noexcept;
  /// The robot's clock now: the stamp of the newest report, and as much later as it came later than the
  /// fastest of the last 30 to 60 ms; after a wait that ended without one also as this computer's clock has
  /// gone on since. `clock()` is behind this one at a late report, and between `silence` and the cycles that
  /// it owes. What sensors send is compared with this one: against a clock that lags they would run ahead.
  [[nodiscard]] skinctl::Nanoseconds clock_now() const noexcept;
  /// Version of the controller, as it says.
  [[nodiscard]] const Version& controller() const noexcept { return rtde_.version(); }
  /// Packages that said nothing we could use.
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return nonsense_; }
  /// Packages whose time stamp was not later than the one before: repeated, out of order, or of a clock that
  /// stands.
  [[nodiscard]] std::uint64_t stood() const noexcept { return stood_; }

  /// The share of full speed that trajectories of the controller get, 0 to 1. False if it could not be sent.
  bool set_speed_slider(double share) noexcept;
  /// 0 to 7 standard, 8 to 15 configurable, 16 and 17 at the tool; read back in `report().digital_outputs`.
  bool set_digital_output(unsigned output, bool on) noexcept;
  /// What the flange carries [kg], and its centre of mass in the flange's frame [m]. Runs beside the program.
  bool set_payload(double mass, const std::array<double, 3>& centre);
  /// Releases a protective stop: only ever on this request. Throws `ConnectionError` with the robot's answer,
  /// such as that five seconds have not passed yet.
  void unlock_protective_stop();

 private:
  bool send(skinctl::Interface interface, const double (&numbers)[6]) noexcept;
  bool deliver(const std::array<double, 6>& numbers, std::int32_t mode) noexcept;
  bool post(const std::array<double, 6>& numbers, std::int32_t mode, Timeout timeout) noexcept;
  [[nodiscard]] bool echoes() const noexcept {
    return config_.echo && config_.real_time && rtde_.version().has_upper_registers();
  }
  void take_echo() noexcept;
  void power_up();
  void subscribe();
  void refresh();
  void act(const char* dashboard_command, const char* rest_action);
  void upload();
  [[nodiscard]] bool by_rest() const noexcept;
  [[nodiscard]] bool is_state(const Package& package, Report& report) const noexcept;
  [[nodiscard]] Fault halted() noexcept;
  [[nodiscard]] bool clocks_agree() noexcept;
  void time_state() noexcept;
  [[nodiscard]] skinctl::Nanoseconds stamp() const noexcept;
  bool take(const Package& first) noexcept;
  [[nodiscard]] std::string explanation() const;
  skinctl::Heard fail(Fault fault, const std::string& detail = {}) noexcept;

  DriverConfig config_;
  boost::asio::io_context io_;
  RtdeClient rtde_;
  Stream script_, reverse_;
  std::uint8_t recipe_ = 0, inputs_ = 0;
  Report report_;
  std::string error_;
  Fault fault_ = Fault::none;
  std::uint64_t nonsense_ = 0, stood_ = 0;
  std::array<double, 6> sent_{}, sent_before_{};  ///< the last two commands
  bool running_ = false;
  int silent_waits_ = 0;                                 ///< ended without a state, since the last one
  std::chrono::steady_clock::time_point waits_since_{};  ///< for the state that is missing
  std::chrono::steady_clock::time_point heard_at_{};     ///< the newest state
  /// The robot's clock less this computer's, by the fastest state since `fastest_since_`, and before.
  skinctl::Nanoseconds fastest_{}, fastest_before_{};
  std::chrono::steady_clock::time_point fastest_since_{};
  skinctl::Nanoseconds late_{};  ///< how much later than the fastest the newest state came
  std::uint64_t nonsense_before_ = 0, stood_before_ = 0;  ///< when that wait began
  bool playing_ = false;                                  ///< our program has been seen to run
  double started_ = 0, slider_up_ = 0, finite_at_ = 0;    ///< by the controller's clock [s]
  std::chrono::steady_clock::time_point window_{};
  double window_stamp_ = 0;
  int wrong_windows_ = 0;
  static constexpr std::int32_t kept = 512;
  static_assert(echo_numbers % kept == 0, "a number has the same place in every round");
  std::array<std::chrono::steady_clock::time_point, kept>
      posted_at_{};          ///< the newest messages, by their number
  std::int32_t posted_ = 0;  ///< messages to the program
  double round_trip_ = -1;
};

}  // namespace adapters::ur5
