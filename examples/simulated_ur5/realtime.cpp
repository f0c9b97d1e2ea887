#include "examples/simulated_ur5/realtime.hpp"

#include "examples/simulated_ur5/wire.hpp"

namespace simulated_ur5::realtime {
namespace {

using Numbers = BigEndianWriter;

template <std::size_t N>
void put(Numbers& w, const std::array<double, N>& values) {
  for (const double v : values) w.f64(v);
}
void put(Numbers& w, Vec3 v) {
  for (const double x : {v.x, v.y, v.z}) w.f64(x);
}
/// What the maker keeps for itself.
template <int N>
void reserved(Numbers& w, const RobotState&) {
  for (int i = 0; i < N; ++i) w.f64(0);
}

/// Codes of the program's state in this packet differ from those of RTDE by nothing.
double code(RuntimeState s) {
  return static_cast<double>(static_cast<std::uint32_t>(s));
}

/// Fields in their order, and from which generation on they are there.
struct Field {
  enum { both, e_series } since;
  void (*write)(Numbers&, const RobotState&);
};
constexpr Field fields[] = {
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(s.timestamp); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_q); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_dq); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_ddq); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_current); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_moment); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.actual_q); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.actual_dq); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.actual_current); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.control_output); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.actual_tcp_pose); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.actual_tcp_speed); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.actual_tcp_force); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_tcp_pose); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.target_tcp_speed); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(static_cast<double>(s.digital_inputs)); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.temperatures); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(s.execution_time); }},
    {Field::both, reserved<1>},  // test value
    {Field::both,
     [](Numbers& w, const RobotState& s) { w.f64(static_cast<double>(static_cast<int>(s.robot_mode))); }},
    {Field::both,
     [](Numbers& w, const RobotState& s) {
       for (std::size_t i = 0; i < joint_count; ++i) w.f64(s.joint_mode);
     }},
    {Field::both,
     [](Numbers& w, const RobotState& s) { w.f64(static_cast<double>(static_cast<int>(s.safety_mode))); }},
    {Field::both, reserved<6>},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.tool_acceleration); }},
    {Field::both, reserved<6>},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(s.speed_scaling); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(s.momentum); }},
    {Field::both, reserved<2>},
    {Field::both, [](Numbers& w, const RobotState&) { w.f64(48); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(s.power_on ? 48 : 0); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(s.power_on ? 0.5 : 0); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.joint_voltage); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(static_cast<double>(s.digital_outputs)); }},
    {Field::both, [](Numbers& w, const RobotState& s) { w.f64(code(s.runtime_state)); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.elbow_position); }},
    {Field::both, [](Numbers& w, const RobotState& s) { put(w, s.elbow_velocity); }},
    {Field::both,
     [](Numbers& w, const RobotState& s) { w.f64(static_cast<double>(static_cast<int>(s.safety_mode))); }},
    {Field::e_series, reserved<3>},
    {Field::e_series, [](Numbers& w, const RobotState& s) { w.f64(s.payload); }},
    {Field::e_series, [](Numbers& w, const RobotState& s) { put(w, s.payload_cog); }},
    {Field::e_series, [](Numbers& w, const RobotState& s) { put(w, s.payload_inertia); }},
};

}  // namespace

void write_packet(std::vector<std::uint8_t>& out, const RobotState& state, Series series) {
  Numbers w(out);
  w.u32(static_cast<std::uint32_t>(packet_size(series)));
  for (const Field& field : fields)
    if (field.since == Field::both || series == Series::e_series) field.write(w, state);
}

}  // namespace simulated_ur5::realtime
