// What a program can ask the controller.
#include "examples/simulated_ur5/kinematics.hpp"
#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

Value vector(Vec3 v) {
  return list_of(std::array<double, 3>{v.x, v.y, v.z});
}
template <class Registers>
Outcome entry(Call& c, const Registers& registers) {
  const auto i = c.index(registers.size());
  if (!i) return c.fail("runtime_error_index");
  if constexpr (std::is_same_v<std::decay_t<decltype(registers[0])>, std::int32_t>)
    return c.give(static_cast<std::int64_t>(registers[*i]));
  else
    return c.give(Value(registers[*i]));
}
Outcome bit(Call& c, std::uint64_t word, std::size_t first, std::size_t count) {
  const auto i = c.index(count);
  return i ? c.give((word >> (first + *i) & 1u) != 0) : c.fail("runtime_error_index");
}

constexpr Builtin state_table[] = {
    {"get_steptime", "", [](Call& c) { return c.give(seconds(c.robot.cycle)); }},
    {"get_actual_joint_positions", "", [](Call& c) { return c.give(list_of(c.robot.arm.measured_q())); }},
    {"get_joint_positions", "", [](Call& c) { return c.give(list_of(c.robot.arm.measured_q())); }},
    {"get_actual_joint_positions_history", "steps",
     [](Call& c) { return c.give(list_of(c.robot.arm.measured_q())); }},
    {"get_target_joint_positions", "", [](Call& c) { return c.give(list_of(c.robot.arm.target_q())); }},
    {"get_actual_joint_speeds", "", [](Call& c) { return c.give(list_of(c.robot.arm.measured_dq())); }},
    {"get_joint_speeds", "", [](Call& c) { return c.give(list_of(c.robot.arm.measured_dq())); }},
    {"get_target_joint_speeds", "", [](Call& c) { return c.give(list_of(c.robot.arm.target_dq())); }},
    {"get_target_joint_accelerations", "", [](Call& c) { return c.give(list_of(c.robot.arm.target_ddq())); }},
    {"get_joint_torques", "", [](Call& c) { return c.give(list_of(c.robot.state.torque)); }},
    {"get_joint_temp", "j", [](Call& c) { return entry(c, c.robot.state.temperatures); }},
    {"get_actual_tcp_pose", "", [](Call& c) { return c.give(Value(c.robot.state.actual_tcp_pose)); }},
    {"get_target_tcp_pose", "", [](Call& c) { return c.give(Value(c.robot.state.target_tcp_pose)); }},
    {"get_target_waypoint", "",
     [](Call& c) { return c.give(Value(c.robot.line.goal.value_or(c.robot.state.target_tcp_pose))); }},
    {"get_actual_tcp_speed", "", [](Call& c) { return c.give(list_of(c.robot.state.actual_tcp_speed)); }},
    {"get_target_tcp_speed", "", [](Call& c) { return c.give(list_of(c.robot.state.target_tcp_speed)); }},
    {"get_actual_tool_flange_pose", "",
     [](Call& c) { return c.give(Value(six_of(forward_kinematics(c.robot.arm.measured_q()).flange))); }},
    {"get_tcp_force", "", [](Call& c) { return c.give(list_of(c.robot.state.actual_tcp_force)); }},
    {"force", "", [](Call& c) { return c.give(c.robot.state.tcp_force); }},
    {"get_tcp_offset", "", [](Call& c) { return c.give(Value(c.robot.state.tcp_offset)); }},
    {"get_target_payload", "", [](Call& c) { return c.give(c.robot.state.payload); }},
    {"get_target_payload_cog", "", [](Call& c) { return c.give(vector(c.robot.state.payload_cog)); }},
    {"get_controller_temp", "", [](Call& c) { return c.give(32.0); }},
    {"is_steady", "", [](Call& c) { return c.give(c.robot.arm.at_rest()); }},
    {"is_within_safety_limits", "q",
     [](Call& c) {
       const auto q = c[0].as<Pose6>() ? joints_that_reach(pose_of(*c[0].as<Pose6>()), c.robot.arm.target_q())
                                       : c[0].six();
       bool within = q.has_value();
       for (std::size_t i = 0; within && i < joint_count; ++i)
         within = (*q)[i] >= c.robot.state.limits.lower[i] && (*q)[i] <= c.robot.state.limits.upper[i];
       return c.give(within);
     }},
    {"read_input_boolean_register", "address",
     [](Call& c) { return entry(c, c.robot.state.inputs.registers.bits); }},
    {"read_input_integer_register", "address",
     [](Call& c) { return entry(c, c.robot.state.inputs.registers.integers); }},
    {"read_input_float_register", "address",
     [](Call& c) { return entry(c, c.robot.state.inputs.registers.doubles); }},
    {"read_output_boolean_register", "address", [](Call& c) { return entry(c, c.robot.state.outputs.bits); }},
    {"read_output_integer_register", "address",
     [](Call& c) { return entry(c, c.robot.state.outputs.integers); }},
    {"read_output_float_register", "address",
     [](Call& c) { return entry(c, c.robot.state.outputs.doubles); }},
    {"get_standard_digital_in", "n", [](Call& c) { return bit(c, c.robot.state.digital_inputs, 0, 8); }},
    {"get_configurable_digital_in", "n", [](Call& c) { return bit(c, c.robot.state.digital_inputs, 8, 8); }},
    {"get_tool_digital_in", "n", [](Call& c) { return bit(c, c.robot.state.digital_inputs, 16, 2); }},
    {"get_digital_in", "n", [](Call& c) { return bit(c, c.robot.state.digital_inputs, 0, 8); }},
    {"get_standard_digital_out", "n", [](Call& c) { return bit(c, c.robot.state.digital_outputs, 0, 8); }},
    {"get_configurable_digital_out", "n",
     [](Call& c) { return bit(c, c.robot.state.digital_outputs, 8, 8); }},
    {"get_tool_digital_out", "n", [](Call& c) { return bit(c, c.robot.state.digital_outputs, 16, 2); }},
    {"get_digital_out", "n", [](Call& c) { return bit(c, c.robot.state.digital_outputs, 0, 8); }},
    {"get_standard_analog_in", "n", [](Call& c) { return c.give(0.0); }},
};

}  // namespace

std::span<const Builtin> state_functions() {
  return state_table;
}

}  // namespace simulated_ur5::urscript
