// What the controller knows of itself in one cycle: the source of every RTDE output and the sink of every
// input.
#pragma once

#include <array>
#include <cstdint>

#include "examples/simulated_ur5/arm.hpp"

namespace simulated_ur5 {

enum class RobotMode : std::int32_t {
  no_controller = -1,
  disconnected = 0,
  confirm_safety = 1,
  booting = 2,
  power_off = 3,
  power_on = 4,
  idle = 5,
  backdrive = 6,
  running = 7,
  updating = 8
};

enum class SafetyMode : std::int32_t {
  normal = 1,
  reduced = 2,
  protective_stop = 3,
  recovery = 4,
  safeguard_stop = 5,
  system_emergency_stop = 6,
  robot_emergency_stop = 7,
  violation = 8,
  fault = 9
};

enum class RuntimeState : std::uint32_t {
  stopping = 0,
  stopped = 1,
  playing = 2,
  pausing = 3,
  paused = 4,
  resuming = 5
};

/// Who moves the joints.
enum class ControlMode : std::uint8_t { position = 0, teach = 1, force = 2, torque = 3 };

inline constexpr std::size_t bit_registers = 128;
inline constexpr std::size_t number_registers = 48;

/// Registers of one direction.
struct Registers {
  std::array<bool, bit_registers> bits{};
  std::array<std::int32_t, number_registers> integers{};
  std::array<double, number_registers> doubles{};
};

/// What RTDE clients write; each number keeps its last value.
struct RobotInputs {
  std::uint32_t speed_slider_mask = 0;
  double speed_slider_fraction = 1;
  std::uint8_t standard_digital_output_mask = 0, standard_digital_output = 0;
  std::uint8_t configurable_digital_output_mask = 0, configurable_digital_output = 0;
  std::uint8_t tool_digital_output_mask = 0, tool_digital_output = 0;
  std::uint8_t standard_analog_output_mask = 0, standard_analog_output_type = 0;
  std::array<double, 2> standard_analog_output{};
  std::array<double, 6> external_force_torque{};
  Registers registers;
};

/// One cycle's outputs.
struct RobotState {
  double timestamp = 0;  ///< [s] since the controller started
  Joints target_q{}, target_dq{}, target_ddq{}, target_moment{}, target_current{};
  Joints actual_q{}, actual_dq{}, actual_current{}, control_output{};
  Joints temperatures{}, joint_voltage{};
  std::array<double, 6> actual_tcp_pose{}, actual_tcp_speed{}, actual_tcp_force{};
  std::array<double, 6> target_tcp_pose{}, target_tcp_speed{};
  std::array<double, 6> raw_wrench{};  ///< of the sensor: at the flange, along its axes, load included
  std::array<double, 6> wrench_by_currents{};  ///< of all contacts, as actual_tcp_force
  Vec3 tool_acceleration, elbow_position, elbow_velocity;
  double momentum = 0, tcp_force = 0;
  double execution_time = 0;  ///< of the controller's cycle [ms]
  RobotMode robot_mode = RobotMode::power_off;
  SafetyMode safety_mode = SafetyMode::normal;
  RuntimeState runtime_state = RuntimeState::stopped;
  std::int32_t joint_mode = 239;  ///< 239 power off, 247 booting, 253 running, 255 idle
  bool power_on = false;
  bool program_running = false;
  double speed_scaling = 0, target_speed_fraction = 1;
  std::uint64_t digital_inputs = 0, digital_outputs = 0;
  ControlMode control_mode = ControlMode::position;
  std::array<double, 6> tcp_offset{};  ///< of the tool's point in the flange's frame [m], rotation vector
  double payload = 0;                  ///< [kg]
  Vec3 payload_cog{};                  ///< [m] from the flange
  std::array<double, 6> payload_inertia{};  ///< xx, yy, zz, xy, xz, yz [kg m^2]
  Vec3 gravity{0, 0, -9.82};                ///< that the controller reckons with [m/s^2]
  int tool_voltage = 0;                     ///< [V]
  Joints torque{};                          ///< that the motors give at the joints [N m]
  double position_deviation = 0;            ///< share of the deviation that would stop the robot
  double collision = 0;                     ///< share of the force that would stop the robot
  std::uint64_t control_step = 0;           ///< cycles since the controller started
  std::uint32_t script_line = 0;            ///< of the main program
  struct Limits {
    Joints lower{}, upper{}, speed{}, acceleration{};
  } limits;
  Registers outputs;
  RobotInputs inputs;
};

}  // namespace simulated_ur5
