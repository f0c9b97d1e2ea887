#include "examples/simulated_ur5/rtde.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace simulated_ur5::rtde {
namespace {

using Writer = BigEndianWriter;
using Reader = BigEndianReader;

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
    {"tool_output_voltage", Type::int32, [](const RobotState&, std::size_t, Writer& w) { w.i32(0); }},
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
    {"payload", Type::real, [](const RobotState&, std::size_t, Writer& w) { real(w, 0); }},
    {"payload_cog", Type::vector3, [](const RobotState&, std::size_t, Writer& w) { vector3(w, {}); }},
    {"payload_inertia", Type::vector6, [](const RobotState&, std::size_t, Writer& w) { vector6(w, {}); }},
    {"tcp_offset", Type::vector6, [](const RobotState&, std::size_t, Writer& w) { vector6(w, {}); }},
    {"script_control_line", Type::uint32, [](const RobotState&, std::size_t, Writer& w) { w.u32(0); }},
    {"ft_raw_wrench", Type::vector6,
     [](const RobotState& s, std::size_t, Writer& w) { vector6(w, s.actual_tcp_force); }},
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

/// The number behind `prefix` in `name`, if there is one below `count`, written without leading zeros.
std::optional<std::size_t> number_behind(std::string_view name, std::string_view prefix, std::size_t count) {
  if (!name.starts_with(prefix)) return std::nullopt;
  const std::string_view digits = name.substr(prefix.size());
  if (digits.empty() || digits.size() > 3 || (digits.size() > 1 && digits[0] == '0')) return std::nullopt;
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || value >= count) return std::nullopt;
  return value;
}

}  // namespace

std::string_view type_name(Type type) {
  constexpr std::string_view names[] = {"BOOL",   "UINT8",    "UINT32",   "UINT64",       "INT32",
                                        "DOUBLE", "VECTOR3D", "VECTOR6D", "VECTOR6INT32", "VECTOR6UINT32"};
  return names[static_cast<std::size_t>(type)];
}

std::size_t type_size(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 4, 8, 4, 8, 24, 48, 24, 24};
  return sizes[static_cast<std::size_t>(type)];
}

void Framer::feed(std::span<const std::uint8_t> bytes) {
  const std::size_t n = std::min(bytes.size(), room());
  std::memcpy(buffer_ + size_, bytes.data(), n);
  size_ += n;
}

std::optional<Framer::Frame> Framer::next() {
  if (taken_ > 0) {
    std::memmove(buffer_, buffer_ + taken_, size_ - taken_);
    size_ -= taken_;
    taken_ = 0;
  }
  if (broken_ || size_ < header_size) return std::nullopt;
  const auto claimed = static_cast<std::size_t>(buffer_[0] << 8 | buffer_[1]);
  if (claimed < header_size || claimed > largest_request) {
    broken_ = true;
    return std::nullopt;
  }
  if (size_ < claimed) return std::nullopt;
  taken_ = claimed;
  return Frame{buffer_[2], {buffer_ + header_size, claimed - header_size}};
}

std::optional<Output> find_output(std::string_view name) {
  for (const NamedOutput& o : outputs)
    if (o.name == name) return Output{o.type, o.write, 0};
  for (const OutputFamily& f : output_families)
    if (const auto i = number_behind(name, f.prefix, f.count)) return Output{f.type, f.write, *i};
  return std::nullopt;
}

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

std::vector<std::string> output_names() {
  std::vector<std::string> names;
  for (const NamedOutput& o : outputs) names.emplace_back(o.name);
  for (const OutputFamily& f : output_families)
    for (std::size_t i = 0; i < f.count; ++i) names.push_back(std::string(f.prefix) + std::to_string(i));
  return names;
}

std::vector<std::string> input_names() {
  std::vector<std::string> names;
  for (const NamedInput& i : inputs) names.emplace_back(i.name);
  for (const InputFamily& f : input_families)
    for (std::size_t i = f.first; i < f.count; ++i)
      names.push_back(std::string(f.prefix) + std::to_string(i));
  return names;
}

std::vector<std::string_view> split_names(std::string_view names) {
  std::vector<std::string_view> out;
  while (!names.empty()) {
    const std::size_t comma = names.find(',');
    out.push_back(names.substr(0, comma));
    if (comma == std::string_view::npos) break;
    names.remove_prefix(comma + 1);
  }
  return out;
}

PackageWriter::PackageWriter(std::vector<std::uint8_t>& out, Package type)
    : BigEndianWriter(out), out_(out), start_(out.size()) {
  u16(0);
  u8(static_cast<std::uint8_t>(type));
}

void PackageWriter::finish() {
  const std::size_t size = out_.size() - start_;
  out_[start_] = static_cast<std::uint8_t>(size >> 8);
  out_[start_ + 1] = static_cast<std::uint8_t>(size);
}

void write_text(std::vector<std::uint8_t>& out, int version, Level level, std::string_view text,
                std::string_view source) {
  PackageWriter w(out, Package::text_message);
  text = text.substr(0, 255);
  source = source.substr(0, 255);
  if (version >= 2) {
    w.u8(static_cast<std::uint8_t>(text.size()));
    w.text(text);
    w.u8(static_cast<std::uint8_t>(source.size()));
    w.text(source);
    w.u8(static_cast<std::uint8_t>(level));
  } else {
    w.u8(static_cast<std::uint8_t>(level));
    w.text(text);
  }
  w.finish();
}

}  // namespace simulated_ur5::rtde
