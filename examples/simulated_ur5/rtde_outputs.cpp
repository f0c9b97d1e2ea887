// What the robot sends: names, types and where the values come from.
#include "examples/simulated_ur5/rtde.hpp"
#include "examples/simulated_ur5/rtde_names.hpp"

namespace simulated_ur5::rtde {
namespace {

using Writer = BigEndianWriter;

void vector6(Writer& w, const std::array<double, 6>& v) {
  for (double x : v) w.f64(x);
}
void vector3(Writer& w, Vec3 v) {
  w.f64(v.x);
  w.f64(v.y);
  w.f64(v.z);
}

std::uint32_t bits_from(const std::array<bool, bit_registers>& bits, std::size_t first) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 32; ++i) word |= std::uint32_t{bits[first + i]} << i;
  return word;
}

std::uint32_t status_bits(const RobotState& s) {
  return (s.power_on ? 1u : 0u) | (s.program_running ? 2u : 0u);
}

std::uint32_t safety_bits(const RobotState& s) {
  const auto is = [&](SafetyMode mode) { return s.safety_mode == mode; };
  const bool emergency = is(SafetyMode::system_emergency_stop) || is(SafetyMode::robot_emergency_stop);
  const bool flags[11] = {is(SafetyMode::normal),
                          is(SafetyMode::reduced),
                          is(SafetyMode::protective_stop),
                          is(SafetyMode::recovery),
                          is(SafetyMode::safeguard_stop),
                          is(SafetyMode::system_emergency_stop),
                          is(SafetyMode::robot_emergency_stop),
                          emergency,
                          is(SafetyMode::violation),
                          is(SafetyMode::fault),
                          !is(SafetyMode::normal) && !is(SafetyMode::reduced)};
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 11; ++i) word |= std::uint32_t{flags[i]} << i;
  return word;
}

struct NamedOutput {
  std::string_view name;
  Type type;
  void (*write)(const RobotState&, std::size_t, Writer&);
};

#define SIMULATED_UR5_VECTOR6(name, member)                                                        \
  NamedOutput {                                                                                    \
    name, Type::vector6, [](const RobotState& s, std::size_t, Writer& w) { vector6(w, s.member); } \
  }

void real(Writer& w, double v) {
  w.f64(v);
}

const NamedOutput outputs[] = {
    {"timestamp", Type::real, [](const RobotState& s, std::size_t, Writer& w) { real(w, s.timestamp); }},
    SIMULATED_UR5_VECTOR6("target_q", target_q),
    SIMULATED_UR5_VECTOR6("target_qd", target_dq),
    SIMULATED_UR5_VECTOR6("target_qdd", target_ddq),
    SIMULATED_UR5_VECTOR6("target_current", target_current),
    SIMULATED_UR5_VECTOR6("target_moment", target_moment),
    SIMULATED_UR5_VECTOR6("actual_q", actual_q),
    SIMULATED_UR5_VECTOR6("actual_qd", actual_dq),
    SIMULATED_UR5_VECTOR6("actual_current", actual_current),
    {"actual_current_window", Type::vector6,
     [](const RobotState&, std::size_t, Writer& w) { vector6(w, {0.6, 0.6, 0.6, 0.3, 0.3, 0.3}); }},
    SIMULATED_UR5_VECTOR6("joint_control_output", control_output),
    SIMULATED_UR5_VECTOR6("actual_TCP_pose", actual_tcp_pose),
    SIMULATED_UR5_VECTOR6("actual_TCP_speed", actual_tcp_speed),
    SIMULATED_UR5_VECTOR6("actual_TCP_force", actual_tcp_force),
    SIMULATED_UR5_VECTOR6("target_TCP_pose", target_tcp_pose),
    SIMULATED_UR5_VECTOR6("target_TCP_speed", target_tcp_speed),
    {"actual_digital_input_bits", Type::uint64,
     [](const RobotState& s, std::size_t, Writer& w) { w.u64(s.digital_inputs); }},
    SIMULATED_UR5_VECTOR6("joint_temperatures", temperatures),
    {"actual_execution_time", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.execution_time); }},
    {"robot_mode", Type::int32,
     [](const RobotState& s, std::size_t, Writer& w) { w.i32(static_cast<std::int32_t>(s.robot_mode)); }},
    {"joint_mode", Type::vector6_int32,
     [](const RobotState& s, std::size_t, Writer& w) {
       for (std::size_t i = 0; i < joint_count; ++i) w.i32(s.joint_mode);
     }},
    {"safety_mode", Type::int32,
     [](const RobotState& s, std::size_t, Writer& w) { w.i32(static_cast<std::int32_t>(s.safety_mode)); }},
    {"safety_status", Type::int32,
     [](const RobotState& s, std::size_t, Writer& w) { w.i32(static_cast<std::int32_t>(s.safety_mode)); }},
    {"actual_tool_accelerometer", Type::vector3,
     [](const RobotState& s, std::size_t, Writer& w) { vector3(w, s.tool_acceleration); }},
    {"speed_scaling", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.speed_scaling); }},
    {"target_speed_fraction", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.target_speed_fraction); }},
    {"actual_momentum", Type::real, [](const RobotState& s, std::size_t, Writer& w) { real(w, s.momentum); }},
    {"actual_main_voltage", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 48); }},
    {"actual_robot_voltage", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.power_on ? 48 : 0); }},
    {"actual_robot_current", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.power_on ? 0.5 : 0); }},
    SIMULATED_UR5_VECTOR6("actual_joint_voltage", joint_voltage),
    {"actual_digital_output_bits", Type::uint64,
     [](const RobotState& s, std::size_t, Writer& w) { w.u64(s.digital_outputs); }},
    {"runtime_state", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(static_cast<std::uint32_t>(s.runtime_state)); }},
    {"elbow_position", Type::vector3,
     [](const RobotState& s, std::size_t, Writer& w) { vector3(w, s.elbow_position); }},
    {"elbow_velocity", Type::vector3,
     [](const RobotState& s, std::size_t, Writer& w) { vector3(w, s.elbow_velocity); }},
    {"robot_status_bits", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(status_bits(s)); }},
    {"safety_status_bits", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(safety_bits(s)); }},
    {"analog_io_types", Type::uint32, [](const RobotState&, std::size_t, Writer& w) { w.u32(0); }},
    {"standard_analog_input0", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"standard_analog_input1", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"standard_analog_output0", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.inputs.standard_analog_output[0]); }},
    {"standard_analog_output1", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.inputs.standard_analog_output[1]); }},
    {"io_current", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0.02); }},
    {"euromap67_input_bits", Type::uint32, [](const RobotState&, std::size_t, Writer& w) { w.u32(0); }},
    {"euromap67_output_bits", Type::uint32, [](const RobotState&, std::size_t, Writer& w) { w.u32(0); }},
    {"euromap67_24V_voltage", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"euromap67_24V_current", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"tool_mode", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(static_cast<std::uint32_t>(s.joint_mode)); }},
    {"tool_analog_input_types", Type::uint32, [](const RobotState&, std::size_t, Writer& w) { w.u32(0); }},
    {"tool_analog_input0", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"tool_analog_input1", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"tool_output_voltage", Type::int32,
     [](const RobotState& s, std::size_t, Writer& w) { w.i32(s.tool_voltage); }},
    {"tool_output_current", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"tool_temperature", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 30); }},
    {"tcp_force_scalar", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.tcp_force); }},
    {"output_bit_registers0_to_31", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(bits_from(s.outputs.bits, 0)); }},
    {"output_bit_registers32_to_63", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(bits_from(s.outputs.bits, 32)); }},
    {"input_bit_registers0_to_31", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(bits_from(s.inputs.registers.bits, 0)); }},
    {"input_bit_registers32_to_63", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(bits_from(s.inputs.registers.bits, 32)); }},
    {"payload", Type::real, [](const RobotState& s, std::size_t, Writer& w) { real(w, s.payload); }},
    {"payload_cog", Type::vector3,
     [](const RobotState& s, std::size_t, Writer& w) { vector3(w, s.payload_cog); }},
    SIMULATED_UR5_VECTOR6("payload_inertia", payload_inertia),
    SIMULATED_UR5_VECTOR6("tcp_offset", tcp_offset),
    {"script_control_line", Type::uint32,
     [](const RobotState& s, std::size_t, Writer& w) { w.u32(s.script_line); }},
    SIMULATED_UR5_VECTOR6("ft_raw_wrench", raw_wrench),
    SIMULATED_UR5_VECTOR6("wrench_calc_from_currents", wrench_by_currents),
    SIMULATED_UR5_VECTOR6("actual_current_as_torque", torque),
    {"joint_position_deviation_ratio", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.position_deviation); }},
    {"collision_detection_ratio", Type::real,
     [](const RobotState& s, std::size_t, Writer& w) { real(w, s.collision); }},
    // 0: nothing slows the program; 1: the speed slider.
    {"time_scale_source", Type::int32,
     [](const RobotState& s, std::size_t, Writer& w) { w.i32(s.target_speed_fraction < 1 ? 1 : 0); }},
    {"target_gravity", Type::vector3,
     [](const RobotState& s, std::size_t, Writer& w) { vector3(w, s.gravity); }},
    {"target_base_acceleration", Type::vector6,
     [](const RobotState&, std::size_t, Writer& w) { vector6(w, {}); }},
    {"target_base_wrench", Type::vector6, [](const RobotState&, std::size_t, Writer& w) { vector6(w, {}); }},
    {"control_step", Type::uint64,
     [](const RobotState& s, std::size_t, Writer& w) { w.u64(s.control_step); }},
    {"tool_output_mode", Type::uint8, [](const RobotState&, std::size_t, Writer& w) { w.u8(0); }},
    {"tool_digital_output0_mode", Type::uint8, [](const RobotState&, std::size_t, Writer& w) { w.u8(1); }},
    {"tool_digital_output1_mode", Type::uint8, [](const RobotState&, std::size_t, Writer& w) { w.u8(1); }},
    {"actual_robot_energy_consumed", Type::real,
     [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"actual_robot_braking_energy_dissipated", Type::real,
     [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"encoder0_raw", Type::int32, [](const RobotState&, std::size_t, Writer& w) { w.i32(0); }},
    {"encoder1_raw", Type::int32, [](const RobotState&, std::size_t, Writer& w) { w.i32(0); }},
};
#undef SIMULATED_UR5_VECTOR6

/// A family of numbered registers.
struct OutputFamily {
  std::string_view prefix;
  std::size_t count;
  Type type;
  void (*write)(const RobotState&, std::size_t, Writer&);
};

const OutputFamily output_families[] = {
    {"output_bit_register_", bit_registers, Type::boolean,
     [](const RobotState& s, std::size_t i, Writer& w) { w.u8(s.outputs.bits[i] ? 1 : 0); }},
    {"output_int_register_", number_registers, Type::int32,
     [](const RobotState& s, std::size_t i, Writer& w) { w.i32(s.outputs.integers[i]); }},
    {"output_double_register_", number_registers, Type::real,
     [](const RobotState& s, std::size_t i, Writer& w) { w.f64(s.outputs.doubles[i]); }},
    {"input_bit_register_", bit_registers, Type::boolean,
     [](const RobotState& s, std::size_t i, Writer& w) { w.u8(s.inputs.registers.bits[i] ? 1 : 0); }},
    {"input_int_register_", number_registers, Type::int32,
     [](const RobotState& s, std::size_t i, Writer& w) { w.i32(s.inputs.registers.integers[i]); }},
    {"input_double_register_", number_registers, Type::real,
     [](const RobotState& s, std::size_t i, Writer& w) { w.f64(s.inputs.registers.doubles[i]); }},
};

}  // namespace

std::optional<Output> find_output(std::string_view name) {
  for (const NamedOutput& o : outputs)
    if (o.name == name) return Output{o.type, o.write, 0};
  for (const OutputFamily& f : output_families)
    if (const auto i = number_behind(name, f.prefix, f.count)) return Output{f.type, f.write, *i};
  return std::nullopt;
}

}  // namespace simulated_ur5::rtde
