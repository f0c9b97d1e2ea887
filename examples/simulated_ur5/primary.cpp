#include "examples/simulated_ur5/primary.hpp"

#include "examples/simulated_ur5/robot_data.hpp"
#include "examples/simulated_ur5/wire.hpp"

namespace simulated_ur5::primary {
namespace {

using Bytes = std::vector<std::uint8_t>;

enum Package : std::uint8_t { robot_state = 16, robot_message = 20 };
enum MessageType : std::uint8_t {
  text = 0,
  popup = 2,
  version = 3,
  safety_mode_message = 5,
  error_code = 6,
  key = 7,
  exception = 10
};

/// Where a message comes from: -2 and -3 as bytes.
constexpr std::uint8_t from_interface = 254, from_runtime = 253;
constexpr std::size_t longest_text = 1024, longest_title = 255;

std::uint64_t microseconds(Nanoseconds t) {
  return static_cast<std::uint64_t>(t / 1000);
}

/// A package or sub-package: its size, which is known at the end, before its type.
class Sized : public BigEndianWriter {
 public:
  Sized(Bytes& out, std::uint8_t type) : BigEndianWriter(out), out_(out), start_(out.size()) {
    u32(0);
    u8(type);
  }
  Sized(const Sized&) = delete;
  Sized& operator=(const Sized&) = delete;
  ~Sized() {
    const auto size = static_cast<std::uint32_t>(out_.size() - start_);
    for (std::size_t i = 0; i < 4; ++i) out_[start_ + i] = static_cast<std::uint8_t>(size >> (24 - 8 * i));
  }

  void flag(bool on) { u8(on ? 1 : 0); }
  template <std::size_t N>
  void numbers(const std::array<double, N>& values) {
    for (const double v : values) f64(v);
  }

 private:
  Bytes& out_;
  std::size_t start_;
};

struct Message : Sized {
  Message(Bytes& out, Nanoseconds now, std::uint8_t source, MessageType type) : Sized(out, robot_message) {
    u64(microseconds(now));
    u8(source);
    u8(type);
  }
};

void robot_mode(Sized& w, const RobotState& s) {
  w.u64(microseconds(nanoseconds(s.timestamp)));
  w.flag(true);        // a real robot is connected
  w.flag(s.power_on);  // and enabled
  w.flag(s.power_on);
  w.flag(s.safety_mode == SafetyMode::robot_emergency_stop);
  w.flag(s.safety_mode == SafetyMode::protective_stop);
  w.flag(s.program_running && s.runtime_state != RuntimeState::paused);
  w.flag(s.runtime_state == RuntimeState::paused);
  w.u8(static_cast<std::uint8_t>(s.robot_mode));
  w.u8(static_cast<std::uint8_t>(s.control_mode));
  w.f64(s.target_speed_fraction);
  w.f64(s.speed_scaling);
  w.f64(1);  // limit of the speed fraction
  w.u8(0);   // internal
}

void joints(Sized& w, const RobotState& s) {
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
}

void tool(Sized& w, const RobotState& s) {
  w.u8(0);  // ranges and values of the two analog inputs
  w.u8(0);
  w.f64(0);
  w.f64(0);
  w.f32(s.power_on ? 48 : 0);
  w.u8(static_cast<std::uint8_t>(s.tool_voltage));
  w.f32(0);
  w.f32(30);
  w.u8(static_cast<std::uint8_t>(s.joint_mode));
}

void masterboard(Sized& w, const RobotState& s) {
  w.u32(static_cast<std::uint32_t>(s.digital_inputs));
  w.u32(static_cast<std::uint32_t>(s.digital_outputs));
  w.u8(0);  // ranges and values of the two analog inputs
  w.u8(0);
  w.f64(0);
  w.f64(0);
  const std::uint8_t domains = s.inputs.standard_analog_output_type;
  w.u8(domains & 1u);
  w.u8(domains >> 1 & 1u);
  w.f64(s.inputs.standard_analog_output[0]);
  w.f64(s.inputs.standard_analog_output[1]);
  w.f32(32);  // temperature
  w.f32(s.power_on ? 48 : 0);
  w.f32(s.power_on ? 0.5f : 0);
  w.f32(0.02f);
  w.u8(static_cast<std::uint8_t>(s.safety_mode));
  w.flag(s.safety_mode == SafetyMode::reduced);
  w.u8(0);   // no Euromap 67
  w.u32(0);  // internal
  w.u8(0);   // operational mode selector
  w.u8(0);   // three-position enabling device
  w.u8(0);   // internal
}

void cartesian(Sized& w, const RobotState& s) {
  w.numbers(s.actual_tcp_pose);
  w.numbers(s.tcp_offset);
}

void kinematics(Sized& w, const RobotState&) {
  for (const std::uint32_t sum : robot_data::kinematics_checksum()) w.u32(sum);
  w.numbers(robot_data::dh_theta);
  w.numbers(robot_data::dh_a);
  w.numbers(robot_data::dh_d);
  w.numbers(robot_data::dh_alpha);
  w.u32(robot_data::calibration_linearised);
}

void configuration(Sized& w, const RobotState& s) {
  for (std::size_t i = 0; i < joint_count; ++i) {
    w.f64(s.limits.lower[i]);
    w.f64(s.limits.upper[i]);
  }
  for (std::size_t i = 0; i < joint_count; ++i) {
    w.f64(s.limits.speed[i]);
    w.f64(s.limits.acceleration[i]);
  }
  w.f64(robot_data::default_joint_speed);
  w.f64(robot_data::default_joint_acceleration);
  w.f64(robot_data::default_tool_speed);
  w.f64(robot_data::default_tool_acceleration);
  w.f64(robot_data::equivalent_radius);
  w.numbers(robot_data::dh_a);
  w.numbers(robot_data::dh_d);
  w.numbers(robot_data::dh_alpha);
  w.numbers(robot_data::dh_theta);
  w.i32(robot_data::masterboard_version);
  w.i32(robot_data::controller_box_type);
  w.i32(robot_data::robot_type_ur5);
  w.i32(robot_data::robot_sub_type);
}

void force_mode(Sized& w, const RobotState& s) {
  w.numbers(s.actual_tcp_force);
  w.f64(0);  // dexterity
}

void additional(Sized& w, const RobotState& s) {
  w.u8(0);  // the pendant's button
  w.flag(s.control_mode == ControlMode::teach);
  w.u8(0);
  w.u8(0);
}

void calibration(Sized& w, const RobotState& s) {
  w.numbers(s.actual_tcp_force);
}

void safety(Sized& w, const RobotState&) {
  for (int i = 0; i < 38; ++i) w.u8(0);  // the maker's own
}

void tool_communication(Sized& w, const RobotState&) {
  w.u8(0);
  w.i32(115200);  // baud
  w.i32(0);       // no parity
  w.i32(1);       // stop bits
  w.f32(1.5f);
  w.f32(3.5f);
}

void tool_mode(Sized& w, const RobotState&) {
  for (int i = 0; i < 3; ++i) w.u8(0);
}

/// Sub-packages of a robot state message, in the order in which they come.
struct Part {
  std::uint8_t type;
  enum { always, first, e_series } when;
  void (*write)(Sized&, const RobotState&);
};
constexpr Part parts[] = {
    {0, Part::always, robot_mode},   {1, Part::always, joints},     {2, Part::always, tool},
    {3, Part::always, masterboard},  {4, Part::always, cartesian},  {5, Part::first, kinematics},
    {6, Part::first, configuration}, {7, Part::always, force_mode}, {8, Part::always, additional},
    {9, Part::always, calibration},  {10, Part::always, safety},    {11, Part::e_series, tool_communication},
    {12, Part::e_series, tool_mode}};

}  // namespace

void write_version(Bytes& out, const Version& v, Nanoseconds now) {
  constexpr std::string_view project = "URControl";
  Message w(out, now, from_runtime, version);
  w.u8(static_cast<std::uint8_t>(project.size()));
  w.text(project);
  w.u8(static_cast<std::uint8_t>(v.major));
  w.u8(static_cast<std::uint8_t>(v.minor));
  w.u32(v.bugfix);
  w.u32(v.build);
  w.text("01-01-2023, 00:00:00");
}

void write_state(Bytes& out, const RobotState& s, Nanoseconds, Series series, bool first) {
  const Sized whole(out, robot_state);
  for (const Part& part : parts) {
    const bool wanted = part.when == Part::always || (part.when == Part::first && first) ||
                        (part.when == Part::e_series && series == Series::e_series);
    if (!wanted) continue;
    Sized w(out, part.type);
    part.write(w, s);
  }
}

void write_text(Bytes& out, std::string_view words, Nanoseconds now) {
  Message w(out, now, from_runtime, text);
  w.text(words.substr(0, longest_text));
}

void write_error(Bytes& out, std::int32_t code, std::int32_t argument, ReportLevel level,
                 std::string_view words, Nanoseconds now) {
  Message w(out, now, from_runtime, error_code);
  w.i32(code);
  w.i32(argument);
  w.i32(static_cast<std::int32_t>(level));
  w.u32(0);  // no data
  w.u32(0);
  w.text(words.substr(0, longest_text));
}

void write_safety_mode(Bytes& out, SafetyMode mode, Nanoseconds now) {
  Message w(out, now, from_runtime, safety_mode_message);
  w.i32(0);  // code and argument
  w.i32(0);
  w.u8(static_cast<std::uint8_t>(mode));
  w.u32(0);  // no data
  w.u32(0);
}

void write_key(Bytes& out, std::string_view title, std::string_view words, Nanoseconds now) {
  Message w(out, now, from_runtime, key);
  w.i32(0);
  w.i32(0);
  title = title.substr(0, longest_title);
  w.u8(static_cast<std::uint8_t>(title.size()));
  w.text(title);
  w.text(words.substr(0, longest_text));
}

void write_exception(Bytes& out, std::int32_t line, std::int32_t column, std::string_view words,
                     Nanoseconds now) {
  Message w(out, now, from_interface, exception);
  w.i32(line);
  w.i32(column);
  w.text(words.substr(0, longest_text));
}

void write_popup(Bytes& out, std::string_view title, std::string_view words, bool warning, bool error,
                 bool blocking, Nanoseconds now) {
  Message w(out, now, from_runtime, popup);
  w.u32(0);  // request
  w.u8(0);   // type of the value that is asked for: none
  w.flag(warning);
  w.flag(error);
  w.flag(blocking);
  title = title.substr(0, longest_title);
  w.u8(static_cast<std::uint8_t>(title.size()));
  w.text(title);
  w.text(words.substr(0, longest_text));
}

}  // namespace simulated_ur5::primary
