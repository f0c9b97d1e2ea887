// The Allegro hand's CAN frames, as pure functions: V4, V5 and V5 Sense.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <variant>

#include "examples/adapters/can/frame.hpp"
#include "skinctl/robots/allegro.hpp"

namespace adapters::allegro {

using can::Frame;
using Side = skinctl::allegro::Side;

/// Generations of the hand; their frames have the same ids, and different numbers in them.
enum class Generation : std::uint8_t {
  v4,       ///< torque as PWM; encoder steps of 333.3/65536 degrees
  v5,       ///< torque as a current; encoder steps of 0.088 degrees
  v5_sense  ///< V5 with 16 tactile values and measured currents
};

/// Messages; the id of a frame is `message << 2 | hand`, with the hand's number 0 to 3 on its bus.
namespace message {
inline constexpr std::uint16_t current = 0x00;   ///< Sense: + 0 fingers 0 and 1, + 3 fingers 2 and 3
inline constexpr std::uint16_t position = 0x20;  ///< + finger
inline constexpr std::uint16_t imu = 0x30;
inline constexpr std::uint16_t temperature = 0x38;  ///< + finger
inline constexpr std::uint16_t servo_on = 0x40;
inline constexpr std::uint16_t servo_off = 0x41;
inline constexpr std::uint16_t tactile = 0x54;  ///< Sense: see `TactileFrames`
inline constexpr std::uint16_t torque = 0x60;   ///< + finger
inline constexpr std::uint16_t info = 0x80;     ///< remote request and its answer
inline constexpr std::uint16_t period = 0x81;
inline constexpr std::uint16_t serial = 0x88;  ///< remote request and its answer
}  // namespace message

/// A frame's message, without the hand's number.
[[nodiscard]] constexpr std::uint16_t message_of(const Frame& f) noexcept {
  return static_cast<std::uint16_t>(f.id >> 2);
}

// From the computer to the hand.
[[nodiscard]] Frame servo(bool on, unsigned hand = 0) noexcept;
/// Asks for the information or the serial number (a remote frame).
[[nodiscard]] Frame request(std::uint16_t message, unsigned hand = 0) noexcept;
/// Times between two messages of each kind [ms]; 0 stops them.
[[nodiscard]] Frame period(std::uint16_t position_ms, std::uint16_t imu_ms, std::uint16_t temperature_ms,
                           unsigned hand = 0) noexcept;
/// Torques of finger 0 to 3 in units of the wire: PWM (V4) or mA (V5).
[[nodiscard]] Frame torque(unsigned finger, const std::array<std::int16_t, 4>& value,
                           unsigned hand = 0) noexcept;

// From the hand to the computer.

/// Bits of `Info::status`.
namespace status {
inline constexpr std::uint8_t servo_on = 1;
inline constexpr std::uint8_t over_temperature = 2;
inline constexpr std::uint8_t communication_fault = 4;
}  // namespace status

struct Info {
  std::uint16_t hardware = 0, firmware = 0;
  Side side = Side::right;       ///< V4 only: a V5 says it in its serial number
  std::uint8_t temperature = 0;  ///< [C]
  std::uint8_t status = 0;       ///< see `status`
};
struct Serial {
  std::array<char, 8> text{};
  [[nodiscard]] Side side() const noexcept { return text[3] == 'L' ? Side::left : Side::right; }  ///< V5
};
/// Joints 1, 5 and 9 of a V5: geared ones give the same torque at half the current.
enum class Gears : std::uint8_t {
  plain,   ///< the current of every other joint
  geared,  ///< half the current
  unknown  ///< half the current, and at most half of the largest: the smaller torque of both types
};
/// A V5 Sense is geared unless `chosen` says otherwise: all of the maker's drivers halve its current. For a
/// V5 only `chosen` tells: the maker's pages and drivers contradict each other about the letter in the serial
/// number.
[[nodiscard]] constexpr Gears gears(Generation g, std::optional<bool> chosen) noexcept {
  if (g == Generation::v4) return Gears::plain;
  if (chosen) return *chosen ? Gears::geared : Gears::plain;
  return g == Generation::v5_sense ? Gears::geared : Gears::unknown;
}
struct Positions {
  std::uint8_t finger = 0;
  std::array<std::int16_t, 4> count{};
};
struct Orientation {
  std::array<std::uint16_t, 3> angle{};  ///< roll, pitch, yaw in units of the IMU
};
struct Temperature {
  std::uint8_t finger = 0;
  std::int32_t celsius = 0;
};
/// Tactile readings of the cells `first` to `first + count - 1`; a cell that reports itself invalid reads 0.
struct Tactile {
  std::uint8_t first = 0, count = 0;
  std::array<std::uint16_t, 8> reading{};
};
/// Measured currents of the joints `first` to `first + 7` [mA].
struct Currents {
  std::uint8_t first = 0;
  std::array<double, 8> milliampere{};
};
/// A frame that says nothing: another hand's, of an unknown message, of a wrong size, or a request.
struct Unknown {};
using Message = std::variant<Unknown, Info, Serial, Positions, Orientation, Temperature, Tactile, Currents>;

/// Layout of the Sense's tactile frames.
enum class TactileFrames : std::uint8_t {
  two,  ///< 0x54 and 0x55: eight bytes of two fingers, a quarter of the reading each, 255 invalid
  four  ///< older firmware, 0x54 to 0x57: four cells of one finger, 16 bits each, big-endian
};

/// The meaning of a frame from hand number `hand`. Every frame is allowed.
[[nodiscard]] Message decode(const Frame& frame, Generation generation, unsigned hand = 0,
                             TactileFrames tactile = TactileFrames::two) noexcept;

// Numbers.

/// One step of the encoders [rad].
[[nodiscard]] constexpr double encoder_step(Generation g) noexcept {
  return (g == Generation::v4 ? 333.3 / 65536 : 0.088) * std::numbers::pi / 180;
}

/// Whether these can be joints of this generation: no joint of a hand turns by 2.6 rad. Positions of a V4
/// that are read as a V5's are 17 times too large.
[[nodiscard]] constexpr bool plausible(Generation g, const std::array<std::int16_t, 16>& count) noexcept {
  constexpr double farthest = 2.6;  // [rad]
  for (const std::int16_t n : count)
    if (n * encoder_step(g) > farthest || n * encoder_step(g) < -farthest) return false;
  return true;
}

/// What a torque is on the wire: `value = per_newton_metre tau`, cut to `cap`.
struct TorqueScale {
  std::array<double, 16> per_newton_metre{};
  std::array<std::int16_t, 16> cap{};

  /// @param full_torque  V4: the torque of 1200 PWM [N m]; the maker publishes none. V5 does not read it.
  [[nodiscard]] static TorqueScale of(Generation generation, double full_torque, Gears gears) noexcept;

  /// The largest torque of each joint [N m].
  [[nodiscard]] skinctl::JointTorque<16> limit() const noexcept;
  /// Rounded towards zero; a torque that is not a number is 0.
  [[nodiscard]] std::array<std::int16_t, 16> encode(const skinctl::JointTorque<16>& tau) const noexcept;
};

}  // namespace adapters::allegro
