// The messages of the Franka Control Interface, version 7: an FR3 that libfranka 0.13.3 to 0.13.6 speaks to.
// Little-endian, packed. Requests and answers go over TCP, states and commands over UDP.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>

namespace adapters::franka {

inline constexpr std::size_t joints = 7;
inline constexpr std::uint16_t version = 7, default_port = 1337;
inline constexpr std::size_t state_size = 2373, command_size = 371;  ///< of a datagram [bytes]

using SevenJoints = std::array<double, joints>;
/// Column-major, as Franka writes it: rotation, then position [m].
using Pose = std::array<double, 16>;
inline constexpr Pose no_motion{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

enum class Mode : std::uint8_t { other, idle, move, guiding, reflex, user_stopped, recovery };
/// What a motion is made of.
enum class Generator : std::uint8_t { idle, position, velocity, pose, twist, none };
/// What makes torques of it: the robot's own springs, or torques of the client.
enum class Control : std::uint8_t { joint_impedance, cartesian_impedance, torque, other };

/// Places of errors in a state, as far as they are told apart here.
enum class Error : std::uint8_t {
  position_limits = 0,
  velocity = 3,
  joint_reflex = 6,
  cartesian_reflex = 7,
  start_pose = 11,
  position_range = 12,
  velocity_limits = 13,
  velocity_step = 14,
  acceleration_step = 15,
  communication = 25,
  torque_step = 32,
  torque_range = 34
};
inline constexpr std::size_t error_count = 41;
using Errors = std::bitset<error_count>;
/// Franka's name of the error at a place; of one beyond the last: "unknown_error".
[[nodiscard]] const char* name(std::size_t error) noexcept;

/// What the robot sends each millisecond, as far as a job by joints needs it.
struct State {
  std::uint64_t number = 0;                 ///< milliseconds
  Pose pose = no_motion;                    ///< of the flange in the base
  SevenJoints motor_torque{};               ///< of the joints' sensors [N m]
  SevenJoints told_torque{};                ///< commanded last, without that for the weight [N m]
  SevenJoints q{}, told{};                  ///< measured joints, and where they were told to be [rad]
  SevenJoints dq{}, told_dq{}, told_ddq{};  ///< [rad/s], [rad/s^2]
  SevenJoints external{};          ///< torque of the world at the joints, as the robot finds it [N m]
  std::array<double, 6> wrench{};  ///< of the world at the flange, along the base's axes [N], [N m]
  Generator generator = Generator::idle;
  Control control = Control::other;
  Errors errors{};   ///< that hold now
  Errors reasons{};  ///< that ended the last motion
  Mode mode = Mode::other;
  double success = 0;  ///< share of the last 100 commands that came in time
};
/// The answer to a state.
struct Command {
  std::uint64_t number = 0;  ///< of that state
  SevenJoints q{}, dq{};     ///< one of them counts, as the motion's generator says [rad], [rad/s]
  SevenJoints torque{};      ///< [N m]
  bool finished = false;     ///< the motion has ended
};

/// False: another size, an unknown mode, or numbers that are not finite.
[[nodiscard]] bool parse(std::span<const std::uint8_t> bytes, State& out) noexcept;
[[nodiscard]] bool parse(std::span<const std::uint8_t> bytes, Command& out) noexcept;
/// The size of what was written; 0: there is no room.
[[nodiscard]] std::size_t print(const State& state, std::span<std::uint8_t> out) noexcept;
[[nodiscard]] std::size_t print(const Command& command, std::span<std::uint8_t> out) noexcept;

enum class Function : std::uint32_t {
  connect,
  move,
  stop_move,
  set_collision_behavior,
  set_joint_impedance,
  set_cartesian_impedance,
  set_guiding_mode,
  set_ee_to_k,
  set_ne_to_ee,
  set_load,
  recover,
  load_model,
  count
};
/// A request, or the answer to one: both bear its number.
struct Message {
  Function function = Function::count;
  std::uint32_t number = 0;
  std::span<const std::uint8_t> payload{};
};
/// Bytes of an answer's payload that say how it went; 0 is success. Others mean what their function says.
inline constexpr std::uint8_t success = 0;
namespace moved {
inline constexpr std::uint8_t started = 1, preempted = 2, not_possible = 5, invalid = 7, by_reflex = 8,
                              by_emergency = 9;
}
inline constexpr std::uint8_t not_possible = 1, invalid = 2;  ///< of the other functions
inline constexpr std::uint8_t other_version = 1;              ///< of connect

/// Payloads. Those of numbers alone are `Reals`.
struct Connect {
  std::uint16_t version = franka::version, udp_port = 0;
};
struct Move {
  Control control = Control::joint_impedance;
  Generator generator = Generator::position;
};
/// False: another size, or modes that are none.
[[nodiscard]] bool parse(std::span<const std::uint8_t> payload, Connect& out) noexcept;
[[nodiscard]] bool parse(std::span<const std::uint8_t> payload, Move& out) noexcept;
/// False: another count of numbers, or ones that are not finite.
[[nodiscard]] bool parse(std::span<const std::uint8_t> payload, std::span<double> out) noexcept;
[[nodiscard]] std::size_t print(const Connect& payload, std::span<std::uint8_t> out) noexcept;
[[nodiscard]] std::size_t print(const Move& payload, std::span<std::uint8_t> out) noexcept;
[[nodiscard]] std::size_t print(std::span<const double> payload, std::span<std::uint8_t> out) noexcept;
[[nodiscard]] std::size_t print(const Message& message, std::span<std::uint8_t> out) noexcept;

/// Messages of a TCP stream that comes in pieces.
class Inbox {
 public:
  /// Where the next bytes go, and how many came.
  [[nodiscard]] std::span<std::uint8_t> room() noexcept;
  void took(std::size_t count) noexcept;
  /// The next whole one, valid until `room` is called; false: none yet.
  [[nodiscard]] bool next(Message& out) noexcept;
  /// A message longer than all that are known, or none that is known: nothing more is read.
  [[nodiscard]] bool broken() const noexcept { return broken_; }

 private:
  std::array<std::uint8_t, 1024> bytes_{};
  std::size_t begin_ = 0, end_ = 0;
  bool broken_ = false;
};

}  // namespace adapters::franka
