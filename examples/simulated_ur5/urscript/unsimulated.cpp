// Functions of the maker's that this simulator knows by name only: a program that has them runs, one that
// calls them ends with an error.
#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

Outcome refuse(Call& c) {
  return c.fail("runtime_error_not_simulated:" + std::string(c.name) + ":");
}

constexpr Builtin named(std::string_view name) {
  return {name, "", refuse, true, true};
}
constexpr Builtin unsimulated_table[] = {
    named("conveyor_pulse_decode"),
    named("set_conveyor_tick_count"),
    named("get_conveyor_tick_count"),
    named("track_conveyor_linear"),
    named("track_conveyor_circular"),
    named("stop_conveyor_tracking"),
    named("path_offset_enable"),
    named("path_offset_disable"),
    named("path_offset_set"),
    named("position_deviation_warning"),
    named("screw_driving"),
    named("get_mass_matrix"),
    named("get_coriolis_and_centrifugal_torques"),
    named("get_jacobian"),
    named("get_jacobian_time_derivative"),
    named("get_freedrive_status"),
    named("interpolate_pose"),
    named("socket_get_var"),
    named("socket_set_var"),
    named("socket_read_ascii_float"),
    named("socket_read_byte_list"),
    named("rpc_factory"),
    named("modbus_add_signal"),
    named("modbus_get_signal_status"),
    named("modbus_set_output_signal"),
    named("modbus_set_output_register"),
    named("read_port_bit"),
    named("read_port_register"),
    named("write_port_bit"),
    named("write_port_register"),
};

}  // namespace

std::span<const Builtin> unsimulated_functions() {
  return unsimulated_table;
}

}  // namespace simulated_ur5::urscript
