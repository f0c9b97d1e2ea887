// The datagrams of the V5 Sense hand (UDP port 7000), as pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace adapters::allegro {

inline constexpr std::uint16_t sense_port = 7000;

/// Types of datagrams.
enum class DatagramType : std::uint8_t {
  telemetry = 0x02,  ///< from the hand, every 3 ms
  torque = 0x03,     ///< to the hand
  hello = 0x10,      ///< to the hand: begins a session
  hello_answer = 0x11,
  serial = 0x34,  ///< to the hand (of the maker's driver)
  serial_answer = 0x35,
  fault_mask = 0x37,
  motor_error = 0x50
};

/// A datagram: 16 bytes {u32 magic, u8 version, u8 type, u16 length, u32 sequence, u32 ms} and the payload,
/// little-endian.
struct Datagram {
  DatagramType type{};
  std::uint32_t sequence = 0;
  std::uint32_t milliseconds = 0;  ///< of the sender's clock
  std::span<const std::uint8_t> payload;
};

inline constexpr std::size_t header_size = 16, telemetry_size = 164;

/// The parts of a datagram; none where magic, version or length are wrong. What follows the payload is
/// ignored. The payload points into `bytes`.
[[nodiscard]] std::optional<Datagram> parse(std::span<const std::uint8_t> bytes) noexcept;

/// Joints in the order of `skinctl::allegro` (index, middle, ring, thumb). On the wire the thumb comes first.
struct Telemetry {
  std::uint32_t sample = 0;
  std::array<std::int16_t, 16> position{};  ///< steps of the encoders
  std::array<std::int16_t, 16> current{};   ///< [mA]
  std::array<std::uint16_t, 16> tactile{};  ///< cells in their order on the wire, as in CAN frames
  std::array<std::int32_t, 16> velocity{};  ///< in the maker's unit, which is not published
};
struct FaultMask {
  std::uint32_t motors = 0, sensors = 0;  ///< a bit for each that has failed
};
struct MotorError {
  std::uint8_t joint = 0;  ///< from 1
  std::uint8_t status = 0;
};

[[nodiscard]] std::optional<Telemetry> telemetry(const Datagram& d) noexcept;
/// The seven bytes of the information frame of CAN.
[[nodiscard]] std::optional<std::array<std::uint8_t, 7>> hello_answer(const Datagram& d) noexcept;
[[nodiscard]] std::optional<std::array<std::uint8_t, 8>> serial_answer(const Datagram& d) noexcept;
[[nodiscard]] std::optional<FaultMask> fault_mask(const Datagram& d) noexcept;
[[nodiscard]] std::optional<MotorError> motor_error(const Datagram& d) noexcept;

/// A datagram without payload.
[[nodiscard]] std::array<std::uint8_t, 16> plain(DatagramType type, std::uint32_t sequence,
                                                 std::uint32_t milliseconds) noexcept;
/// Currents of the joints [mA].
[[nodiscard]] std::array<std::uint8_t, 48> torques(const std::array<std::int16_t, 16>& value,
                                                   std::uint32_t sequence,
                                                   std::uint32_t milliseconds) noexcept;

}  // namespace adapters::allegro
