// OnRobot RG2 and RG6 grippers: Modbus TCP to the compute box, port 502, unit 65.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "examples/adapters/gripper/dialogue.hpp"
#include "examples/adapters/gripper/modbus.hpp"
#include "examples/adapters/socket.hpp"
#include "skinctl/hardware/gripper.hpp"

namespace adapters::gripper {

/// Registers and bits of an RG gripper.
namespace rg {
inline constexpr std::uint8_t unit = 65;
inline constexpr std::uint16_t target_force = 0,  ///< [0.1 N]; then the width [0.1 mm] and the control word
    fingertip = 258,            ///< how far each fingertip reaches inward of its finger [0.1 mm], signed
    width = 267, status = 268,  ///< between the fingers [0.1 mm]; bits
    tip_width = 275;            ///< between the fingertips [0.1 mm]
inline constexpr std::uint16_t grip = 1, halt = 8,
                               grip_tips = 16;  ///< control words; `grip` is for the fingers' width
inline constexpr std::uint16_t busy = 1, gripping = 2, safety = 0x7c;  ///< status bits 0, 1, 2 to 6
}  // namespace rg

struct OnRobotConfig {
  std::string host = "127.0.0.1";
  std::uint16_t port = 502;
  skinctl::GripperRange range{.opening = 0.11,  ///< of an RG2; its speed cannot be chosen
                              .min_force = 3,
                              .max_force = 40,
                              .min_speed = 0.1,
                              .max_speed = 0.1};
  /// A gripper that does not report a motion so long after a goal has none to make.
  skinctl::Nanoseconds begins_within = std::chrono::milliseconds(150);
  Timeout connect_timeout{2000};
  Patience patience{};
};

/// A `GripperDriver`. `connect` waits and throws `ConnectionError`; nothing else does.
class OnRobot {
 public:
  /// Throws `ConfigurationError` for a range that the registers cannot hold.
  explicit OnRobot(const OnRobotConfig& config);

  void connect();
  [[nodiscard]] skinctl::GripperRange range() const noexcept { return config_.range; }
  bool move(const skinctl::GripperGoal& goal) noexcept;
  skinctl::GripperState poll(skinctl::Nanoseconds now) noexcept;
  void stop() noexcept;
  /// Frames that said nothing we could use.
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return nonsense_; }

 private:
  bool tell(const modbus::Bytes& bytes) noexcept;
  void listen(skinctl::Nanoseconds now) noexcept;
  void hear(const modbus::Frame& frame, skinctl::Nanoseconds now) noexcept;
  void ask() noexcept;

  OnRobotConfig config_;
  Stream stream_;
  std::array<std::uint8_t, 2 * modbus::largest> buffer_{};
  std::size_t filled_ = 0;
  Dialogue dialogue_;
  skinctl::GripperState state_;
  skinctl::GripperGoal goal_;
  skinctl::Nanoseconds since_{};  ///< when the newest goal was acknowledged
  std::uint16_t transaction_ = 0;
  bool pending_ = false, halt_ = false, acknowledged_ = true, seen_busy_ = true;
  bool told_ = false, told_halt_ = false;  ///< the last words were a goal, a stop
  bool busy_ = false;                      ///< with a goal that it was told: it would not hear the next one
  bool connected_ = false;
  std::uint64_t nonsense_ = 0;
};

}  // namespace adapters::gripper
