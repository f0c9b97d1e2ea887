// Robotiq 2F and Hand-E grippers on a UR's controller: text lines over TCP, port 63352.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "examples/adapters/gripper/dialogue.hpp"
#include "examples/adapters/gripper/lines.hpp"
#include "examples/adapters/socket.hpp"
#include "skinctl/hardware/gripper.hpp"

namespace adapters::gripper {

struct RobotiqConfig {
  std::string host = "127.0.0.1";
  std::uint16_t port = 63352;
  skinctl::GripperRange range{.opening = 0.085,  ///< of a 2F-85
                              .min_force = 20,
                              .max_force = 235,
                              .min_speed = 0.02,
                              .max_speed = 0.15};
  int count_open = 0;      ///< POS with open fingers
  int count_closed = 255;  ///< POS with closed fingers: 226 to 230 for some pads
  /// A gripper that is not active is activated: its fingers open and close all the way.
  bool activate = true;
  Timeout connect_timeout{2000};
  Timeout activate_timeout{15000};
  Patience patience{};
};

/// One answer of the gripper.
struct RobotiqAnswer {
  bool acknowledged = false;  ///< "ack"
  std::string_view variable;  ///< of "POS 3"; empty for "ack"
  int value = 0;
};
/// Nothing for a line that is no answer.
[[nodiscard]] std::optional<RobotiqAnswer> parse_robotiq(std::string_view line) noexcept;

/// A `GripperDriver`. `connect` waits and throws `ConnectionError`; nothing else does.
///
/// Its state comes from OBJ (does it move, does it hold) and POS, and only counts for the newest goal once
/// the gripper echoes that goal in PRE: for a while after a new goal OBJ still speaks of the one before.
class Robotiq {
 public:
  /// Throws `ConfigurationError` for a range or counts that cannot be.
  explicit Robotiq(const RobotiqConfig& config);

  void connect();
  [[nodiscard]] skinctl::GripperRange range() const noexcept { return config_.range; }
  bool move(const skinctl::GripperGoal& goal) noexcept;
  skinctl::GripperState poll(skinctl::Nanoseconds now) noexcept;
  void stop() noexcept;
  [[nodiscard]] std::uint64_t nonsense() const noexcept { return nonsense_ + lines_.overlong(); }

 private:
  struct Counts {
    int position = 0, speed = 0, force = 0;
  };
  [[nodiscard]] Counts counts(const skinctl::GripperGoal& goal) const noexcept;
  bool tell(std::string_view line) noexcept;
  bool next_line(std::string_view& line, Timeout timeout) noexcept;
  template <class Is>
  RobotiqAnswer expect(const std::string& question, const Is& is);
  int get(const char* variable);
  void set(const std::string& what);
  void hear(std::string_view line, skinctl::Nanoseconds now) noexcept;
  void ask() noexcept;

  RobotiqConfig config_;
  Stream stream_;
  Lines lines_{"ack"};  // a gripper ends no line after it, some software in between does
  Dialogue dialogue_;
  skinctl::GripperState state_;
  skinctl::GripperGoal goal_;
  Counts wanted_;
  bool pending_ = false, halt_ = false;  ///< a goal, a stop that still has to be sent
  bool told_ = false;                    ///< the last words were a SET
  bool taken_ = false;                   ///< PRE is that of the newest goal
  bool halted_ = false;                  ///< by `stop`, until the next goal
  bool connected_ = false;
  int object_ = 0;  ///< the newest OBJ
  std::size_t turn_ = 0;
  std::uint64_t nonsense_ = 0;
};

}  // namespace adapters::gripper
