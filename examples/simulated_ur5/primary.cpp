#include "examples/simulated_ur5/primary.hpp"

#include "examples/simulated_ur5/wire.hpp"

namespace simulated_ur5::primary {
namespace {

constexpr std::uint8_t robot_state = 16, robot_message = 20;
constexpr std::uint8_t source_controller = 253;

/// Writes the size of a package that began at `start`.
void finish(std::vector<std::uint8_t>& out, std::size_t start) {
  const auto size = static_cast<std::uint32_t>(out.size() - start);
  for (int i = 0; i < 4; ++i)
    out[start + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(size >> (24 - 8 * i));
}

std::uint64_t microseconds(Nanoseconds t) {
  return static_cast<std::uint64_t>(t / 1000);
}

}  // namespace

void write_version(std::vector<std::uint8_t>& out, const Version& version, Nanoseconds now) {
  constexpr std::string_view project = "URControl";
  const std::size_t start = out.size();
  BigEndianWriter w(out);
  w.u32(0);
  w.u8(robot_message);
  w.u64(microseconds(now));
  w.u8(source_controller);
  w.u8(3);
  w.u8(static_cast<std::uint8_t>(project.size()));
  w.text(project);
  w.u8(static_cast<std::uint8_t>(version.major));
  w.u8(static_cast<std::uint8_t>(version.minor));
  w.u32(version.bugfix);
  w.u32(version.build);
  w.text("01-01-2023, 00:00:00");
  finish(out, start);
}

void write_state(std::vector<std::uint8_t>& out, const RobotState& s, Nanoseconds now) {
  const std::size_t start = out.size();
  BigEndianWriter w(out);
  w.u32(0);
  w.u8(robot_state);

  const std::size_t mode = out.size();
  w.u32(0);
  w.u8(0);  // robot mode data
  w.u64(microseconds(now));
  const bool emergency = s.safety_mode == SafetyMode::robot_emergency_stop;
  const bool flags[7] = {true,
                         s.power_on,
                         s.power_on,
                         emergency,
                         s.safety_mode == SafetyMode::protective_stop,
                         s.program_running && s.runtime_state != RuntimeState::paused,
                         s.runtime_state == RuntimeState::paused};
  for (const bool f : flags) w.u8(f ? 1 : 0);
  w.u8(static_cast<std::uint8_t>(s.robot_mode));
  w.u8(0);  // control mode: position
  w.f64(s.target_speed_fraction);
  w.f64(s.speed_scaling);
  w.f64(1);
  w.u8(0);
  finish(out, mode);

  const std::size_t joints = out.size();
  w.u32(0);
  w.u8(1);  // joint data
  for (std::size_t i = 0; i < joint_count; ++i) {
    w.f64(s.actual_q[i]);
    w.f64(s.target_q[i]);
    w.f64(s.actual_dq[i]);
    w.f32(static_cast<float>(s.actual_current[i]));
    w.f32(static_cast<float>(s.joint_voltage[i]));
    w.f32(static_cast<float>(s.temperatures[i]));
    w.f32(0);
    w.u8(static_cast<std::uint8_t>(s.joint_mode));
  }
  finish(out, joints);
  finish(out, start);
}

void write_text(std::vector<std::uint8_t>& out, std::string_view text, Nanoseconds now) {
  const std::size_t start = out.size();
  BigEndianWriter w(out);
  w.u32(0);
  w.u8(robot_message);
  w.u64(microseconds(now));
  w.u8(source_controller);
  w.u8(0);
  w.text(text.substr(0, 1024));
  finish(out, start);
}

}  // namespace simulated_ur5::primary
