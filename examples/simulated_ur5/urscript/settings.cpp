// What a program sets: tool, payload, outputs, registers, modes that are accepted.
#include <algorithm>

#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

Vec3 vector(const Value& v, Vec3 otherwise) {
  const auto n = v.numbers();
  return n && n->size() == 3 ? Vec3{(*n)[0], (*n)[1], (*n)[2]} : otherwise;
}

template <std::size_t First, std::size_t Count>
Outcome digital_output(Call& c) {
  const auto i = c.index(Count);
  if (!i) return c.fail("runtime_error_index");
  const std::uint64_t bit = std::uint64_t{1} << (First + *i);
  auto& outputs = c.robot.state.digital_outputs;
  outputs = c[1].truth() ? outputs | bit : outputs & ~bit;
  return Outcome::done;
}
Outcome analog_output(Call& c) {
  const auto i = c.index(2);
  if (!i) return c.fail("runtime_error_index");
  c.robot.state.inputs.standard_analog_output[*i] = std::clamp(c.number(1, 0), 0.0, 1.0);
  return Outcome::done;
}
Outcome write_boolean(Call& c) {
  const auto i = c.index(bit_registers);
  if (!i) return c.fail("runtime_error_index");
  c.robot.state.outputs.bits[*i] = c[1].truth();
  return Outcome::done;
}
Outcome write_integer(Call& c) {
  const auto i = c.index(number_registers);
  if (!i) return c.fail("runtime_error_index");
  c.robot.state.outputs.integers[*i] =
      static_cast<std::int32_t>(std::clamp(c.number(1, 0), -2147483648.0, 2147483647.0));
  return Outcome::done;
}
Outcome write_float(Call& c) {
  const auto i = c.index(number_registers);
  if (!i) return c.fail("runtime_error_index");
  c.robot.state.outputs.doubles[*i] = c.number(1, 0);
  return Outcome::done;
}

Outcome set_tcp(Call& c) {
  const auto pose = c[0].six();
  if (!pose) return c.fail("runtime_error_type:pose");
  for (const double x : *pose)
    if (!std::isfinite(x)) return c.fail("runtime_error_type:pose");
  c.robot.state.tcp_offset = *pose;
  return Outcome::done;
}
Outcome set_payload(Call& c) {
  const double mass = c.number(0, 0);
  if (!(mass >= 0 && mass <= 1000)) return c.fail("runtime_error_argument:mass:");
  c.robot.state.payload = mass;
  c.robot.state.payload_cog = vector(c[1], {});
  if (const auto inertia = c[2].six()) c.robot.state.payload_inertia = *inertia;
  return Outcome::done;
}
Outcome watchdog(Call& c) {
  Watchdog dog{c.text(0), c.number(1, 10), c.text(2, "pause") == "stop"};
  if (!(dog.min_frequency > 0 && dog.min_frequency <= 1000))
    return c.fail("runtime_error_argument:min_frequency:");
  c.robot.watchdog = dog;
  return Outcome::done;
}
template <ControlMode Mode>
Outcome mode(Call& c) {
  c.robot.state.control_mode = Mode;
  return Outcome::done;
}
Outcome nothing(Call&) {
  return Outcome::done;
}

constexpr Builtin setting_table[] = {
    {"set_standard_digital_out", "n b", digital_output<0, 8>},
    {"set_digital_out", "n b", digital_output<0, 8>},
    {"set_configurable_digital_out", "n b", digital_output<8, 8>},
    {"set_tool_digital_out", "n b", digital_output<16, 2>},
    {"set_standard_analog_out", "n f", analog_output},
    {"set_analog_out", "n f", analog_output},
    {"write_output_boolean_register", "address value", write_boolean},
    {"write_output_integer_register", "address value", write_integer},
    {"write_output_float_register", "address value", write_float},
    {"set_tcp", "pose tcp_name", set_tcp},
    {"set_payload", "m cog inertia", set_payload},
    {"set_target_payload", "m cog inertia transition_time", set_payload},
    {"set_payload_mass", "m", [](Call& c) { return set_payload(c); }},
    {"set_payload_cog", "CoG",
     [](Call& c) {
       c.robot.state.payload_cog = vector(c[0], {});
       return Outcome::done;
     }},
    {"set_gravity", "d",
     [](Call& c) {
       // The maker's argument points up.
       c.robot.state.gravity = -vector(c[0], -c.robot.state.gravity);
       return Outcome::done;
     }},
    {"set_tool_voltage", "voltage",
     [](Call& c) {
       c.robot.state.tool_voltage = static_cast<int>(std::clamp(c.number(0, 0), 0.0, 24.0));
       return Outcome::done;
     }},
    {"rtde_set_watchdog", "variable_name min_frequency action", watchdog},
    {"freedrive_mode", "freeAxes feature", mode<ControlMode::teach>},
    {"end_freedrive_mode", "", mode<ControlMode::position>},
    {"teach_mode", "", mode<ControlMode::teach>},
    {"end_teach_mode", "", mode<ControlMode::position>},
    {"force_mode", "task_frame selection_vector wrench type limits", mode<ControlMode::force>},
    {"end_force_mode", "", mode<ControlMode::position>},
    {"force_mode_set_damping", "damping", nothing},
    {"force_mode_set_gain_scaling", "scaling", nothing},
    {"zero_ftsensor", "", nothing},
    {"enable_external_ft_sensor", "enable sensor_mass sensor_measuring_offset sensor_cog", nothing},
    {"ft_rtde_input_enable", "enable sensor_mass sensor_measuring_offset sensor_cog", nothing},
    {"set_tool_communication", "enabled baud_rate parity stop_bits rx_idle_chars tx_idle_chars", nothing},
    {"set_standard_analog_input_domain", "port domain", nothing},
    {"set_tool_analog_input_domain", "port domain", nothing},
    {"set_safety_mode_transition_hardness", "type", nothing},
};

}  // namespace

std::span<const Builtin> setting_functions() {
  return setting_table;
}

}  // namespace simulated_ur5::urscript
