// The messages of KUKA's Fast Robot Interface: the fields of its protobuf that a job by joint impedance
// needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace adapters::fri {

inline constexpr std::size_t joints = 7;
inline constexpr std::size_t longest = 1500;  ///< of a datagram [bytes]
inline constexpr std::uint64_t monitoring_id = 0x245142, command_id = 0x34001;

using SevenJoints = std::array<double, joints>;

enum class Session : unsigned char { idle, monitoring_wait, monitoring_ready, commanding_wait, commanding };
enum class Quality : unsigned char { poor, fair, good, excellent };
/// The Java program's control mode.
enum class Control : unsigned char { position = 0, cartesian_impedance = 1, joint_impedance = 2, other = 3 };
/// What the Java program's overlay takes beside or in place of positions.
enum class Overlay : unsigned char { none = 0, position = 1, wrench = 2, torque = 3, other = 4 };

struct Header {
  std::uint64_t id = 0;
  std::uint32_t number = 0, reflected = 0;  ///< own counter; counter of the newest message of the other end
};
/// What the controller sends each cycle.
struct Monitoring {
  Header header{.id = monitoring_id};
  std::uint32_t axes = 0;  ///< number of joints, as the controller says it and as its measured positions are
  std::uint32_t safety = 0;  ///< 0: normal operation; else a stop
  Control control = Control::other;
  SevenJoints measured{};                        ///< joint positions [rad]
  std::optional<SevenJoints> measured_torque{};  ///< of the joints' sensors [N m]
  std::optional<SevenJoints> commanded{};        ///< joint positions, not of every version [rad]
  std::optional<SevenJoints>
      external_torque{};  ///< torque of the world, as the controller's own model finds it [N m]
  Session session = Session::idle;
  Quality quality = Quality::poor;
  std::uint32_t period = 0;                   ///< from message to message [ms]; 0: it does not say
  std::uint32_t multiplier = 1;               ///< an answer is due to every so many messages
  std::optional<SevenJoints> interpolated{};  ///< joint positions of the Java program's own motion [rad]
  Overlay overlay = Overlay::none;
};
/// The answer.
struct Command {
  Header header{.id = command_id};
  std::size_t axes = 0;
  SevenJoints position{};               ///< [rad]
  std::optional<SevenJoints> torque{};  ///< beside it [N m]
};

/// False: no such message, cut, or numbers that are not finite. Fields that it does not know are passed over.
[[nodiscard]] bool parse(std::span<const std::uint8_t> bytes, Monitoring& out) noexcept;
[[nodiscard]] bool parse(std::span<const std::uint8_t> bytes, Command& out) noexcept;
/// The size of what was written; 0: there is no room.
[[nodiscard]] std::size_t print(const Monitoring& message, std::span<std::uint8_t> out) noexcept;
[[nodiscard]] std::size_t print(const Command& message, std::span<std::uint8_t> out) noexcept;

}  // namespace adapters::fri
