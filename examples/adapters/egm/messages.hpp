// The messages of ABB's Externally Guided Motion: the fields of its protobuf that a job by position needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace adapters::egm {

inline constexpr std::size_t longest = 1024;  ///< of what is written [bytes]

enum class Motors : unsigned char { unknown, on, off };
enum class Guided : unsigned char { unknown, error, stopped, running };  ///< MCI state
enum class Rapid : unsigned char { unknown, stopped, running };

/// What the controller sends each cycle (EgmRobot).
struct RobotMessage {
  std::uint32_t number = 0, time = 0;           ///< 0 begins a session; [ms]
  std::size_t joints = 0;                       ///< number in `feedback`, the first six of which are kept
  std::array<double, 6> feedback{}, planned{};  ///< [deg]
  bool has_planned = false;
  Motors motors = Motors::unknown;
  Guided guided = Guided::unknown;
  Rapid rapid = Rapid::unknown;
  bool has_force = false;
  std::array<double, 6> force{};  ///< of a force sensor [N], [N m]
};
/// The answer (EgmSensor).
struct SensorMessage {
  std::uint32_t number = 0, time = 0;
  std::size_t joints = 0;
  std::array<double, 6> planned{};  ///< [deg]
};

/// False: no such message, cut, or numbers that are not finite. Fields that it does not know are passed over.
[[nodiscard]] bool parse(std::span<const std::uint8_t> bytes, RobotMessage& out) noexcept;
[[nodiscard]] bool parse(std::span<const std::uint8_t> bytes, SensorMessage& out) noexcept;
/// The size of what was written; 0: there is no room.
[[nodiscard]] std::size_t print(const RobotMessage& message, std::span<std::uint8_t> out) noexcept;
[[nodiscard]] std::size_t print(const SensorMessage& message, std::span<std::uint8_t> out) noexcept;

}  // namespace adapters::egm
