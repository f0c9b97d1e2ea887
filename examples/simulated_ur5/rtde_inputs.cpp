// What clients send: names, types and where the values go.
#include "examples/simulated_ur5/rtde.hpp"
#include "examples/simulated_ur5/rtde_names.hpp"

namespace simulated_ur5::rtde {
namespace {

using Reader = BigEndianReader;

struct NamedInput {
  std::string_view name;
  Type type;
  void (*read)(RobotInputs&, std::size_t, Reader&);
};

void read_bits(RobotInputs& in, std::size_t first, Reader& r) {
  const std::uint32_t word = r.u32();
  for (std::size_t i = 0; i < 32; ++i) in.registers.bits[first + i] = (word >> i & 1u) != 0;
}

const NamedInput inputs[] = {
    {"speed_slider_mask", Type::uint32,
     [](RobotInputs& in, std::size_t, Reader& r) { in.speed_slider_mask = r.u32(); }},
    {"speed_slider_fraction", Type::real,
     [](RobotInputs& in, std::size_t, Reader& r) { in.speed_slider_fraction = r.f64(); }},
    {"standard_digital_output_mask", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.standard_digital_output_mask = r.u8(); }},
    {"standard_digital_output", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.standard_digital_output = r.u8(); }},
    {"configurable_digital_output_mask", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.configurable_digital_output_mask = r.u8(); }},
    {"configurable_digital_output", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.configurable_digital_output = r.u8(); }},
    {"tool_digital_output_mask", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.tool_digital_output_mask = r.u8(); }},
    {"tool_digital_output", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.tool_digital_output = r.u8(); }},
    {"standard_analog_output_mask", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.standard_analog_output_mask = r.u8(); }},
    {"standard_analog_output_type", Type::uint8,
     [](RobotInputs& in, std::size_t, Reader& r) { in.standard_analog_output_type = r.u8(); }},
    {"standard_analog_output_0", Type::real,
     [](RobotInputs& in, std::size_t, Reader& r) { in.standard_analog_output[0] = r.f64(); }},
    {"standard_analog_output_1", Type::real,
     [](RobotInputs& in, std::size_t, Reader& r) { in.standard_analog_output[1] = r.f64(); }},
    {"input_bit_registers0_to_31", Type::uint32,
     [](RobotInputs& in, std::size_t, Reader& r) { read_bits(in, 0, r); }},
    {"input_bit_registers32_to_63", Type::uint32,
     [](RobotInputs& in, std::size_t, Reader& r) { read_bits(in, 32, r); }},
    {"external_force_torque", Type::vector6,
     [](RobotInputs& in, std::size_t, Reader& r) {
       for (double& x : in.external_force_torque) x = r.f64();
     }},
};

struct InputFamily {
  std::string_view prefix;
  std::size_t first, count;
  Type type;
  void (*read)(RobotInputs&, std::size_t, Reader&);
};

const InputFamily input_families[] = {
    {"input_bit_register_", 64, bit_registers, Type::boolean,
     [](RobotInputs& in, std::size_t i, Reader& r) { in.registers.bits[i] = r.u8() != 0; }},
    {"input_int_register_", 0, number_registers, Type::int32,
     [](RobotInputs& in, std::size_t i, Reader& r) { in.registers.integers[i] = r.i32(); }},
    {"input_double_register_", 0, number_registers, Type::real,
     [](RobotInputs& in, std::size_t i, Reader& r) { in.registers.doubles[i] = r.f64(); }},
};

}  // namespace

std::size_t input_key_count() {
  std::size_t n = std::size(inputs);
  for (const InputFamily& f : input_families) n += f.count;
  return n;
}

std::optional<Input> find_input(std::string_view name) {
  std::size_t key = 0;
  for (const NamedInput& i : inputs) {
    if (i.name == name) return Input{i.type, i.read, 0, key};
    ++key;
  }
  for (const InputFamily& f : input_families) {
    if (const auto i = number_behind(name, f.prefix, f.count); i && *i >= f.first)
      return Input{f.type, f.read, *i, key + *i};
    key += f.count;
  }
  return std::nullopt;
}

}  // namespace simulated_ur5::rtde
