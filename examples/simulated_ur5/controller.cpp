#include "examples/simulated_ur5/controller.hpp"

#include <algorithm>
#include <utility>

#include "examples/simulated_ur5/kinematics.hpp"
#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

// Torque per current at the joint [N m/A]: of the order of what such gears and motors give; not the maker's
// numbers.
constexpr Joints torque_constant = {12.5, 12.5, 12.5, 9, 9, 9};
/// A real controller stops when target and joints are about so far apart [rad]; here it is told, not acted
/// on.
constexpr double stopping_deviation = 0.6;
// For so long a led finger stays when nobody says how it is led: ten messages of the live page.
constexpr Nanoseconds finger_waits = nanoseconds(0.5);

std::array<double, 6> six(Vec3 a, Vec3 b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

const char* text_of(Violation violation) {
  switch (violation) {
    case Violation::position_step:
      return "commanded position step beyond the joint speed limit";
    case Violation::speed:
      return "commanded joint speed beyond the limit";
    case Violation::joint_limit:
      return "joint limit";
    case Violation::not_a_number:
      return "command that is no number";
    case Violation::none:
      break;
  }
  return "no violation";
}

}  // namespace

void check(const ControllerConfig& c) {
  using skinctl::require;
  check(c.arm);
  check(c.skin);
  check(c.force_sensor);
  require(c.protective_force >= 0, "protective force", c.protective_force, ">= 0 N");
  require(c.power_on_time >= 0 && c.power_on_time <= 600, "power on time", c.power_on_time, "0 to 600 s");
  require(c.brake_release_time >= 0 && c.brake_release_time <= 600, "brake release time",
          c.brake_release_time, "0 to 600 s");
  require(c.unlock_time >= 0 && c.unlock_time <= 600, "unlock time", c.unlock_time, "0 to 600 s");
}

Controller::Controller(ControllerConfig config)
    : config_((check(config), std::move(config))),
      arm_(config_.arm, cycle_of(config_.series)),
      skin_(config_.cells, config_.skin, config_.seed),
      force_sensor_(config_.force_sensor),
      world_(config_.touches, config_.cells, config_.skin.proximity_distance),
      next_skin_tick_(config_.skin.period) {
  arm_.reseed(config_.seed);
  state_.limits = {config_.arm.lower, config_.arm.upper, config_.arm.velocity_limit,
                   config_.arm.acceleration_limit};
  if (config_.powered) {
    state_.robot_mode = RobotMode::running;
    state_.power_on = true;
  }
  const Pose tool = forward_kinematics(arm_.q()).flange;
  tool_before_ = tool_before_that_ = tool.origin;
  stop_for_safety_ = [this](const std::string& why, std::int32_t code) { protective_stop(why, code); };
  if (!on_notice) on_notice = [](const Notice&) {};
  for (std::size_t i = config_.touches.size(); i-- > 0;)
    if (config_.touches[i].led) led_touch_ = i;
  if (config_.scenario_at_boot) start_scenario();
  publish();
}

void Controller::say(const std::string& text) {
  if (on_message) on_message(text);
}

void Controller::tell(const Notice& notice) {
  if (on_notice) on_notice(notice);
}
void Controller::tell_program(const char* event) {
  tell({Notice::Kind::key, program_name_.empty() ? "unnamed" : program_name_, event});
}

double Controller::scenario_time() const {
  return scenario_runs_ ? seconds(now_ - scenario_start_) : -1;
}

void Controller::press(std::size_t link, Vec3 point, Vec3 normal) {
  if (!led_touch_ || !scenario_runs_) return;
  led_at_ = now_;
  finger_.press(world_, *led_touch_, link, point, normal,
                LedFinger::cell_at(config_.cells, link, point, normal));
}
void Controller::lead_finger(const LedFinger::Wish& wish) {
  wish_ = wish, led_at_ = now_;
}

void Controller::start_scenario() {
  scenario_runs_ = true;
  scenario_start_ = now_;
  world_.restart();
  finger_ = {};
  // From here on everything is a function of the seed and the commands, whenever the client came.
  arm_.reseed(config_.seed);
  skin_.restart(config_.seed + 1);
  force_sensor_.reseed(config_.seed + 2);
  next_skin_tick_ = now_ + config_.skin.period;
}

// ---- power and safety
// -------------------------------------------------------------------------------------------

bool Controller::power_on() {
  if (state_.safety_mode != SafetyMode::normal && state_.safety_mode != SafetyMode::reduced) return false;
  if (state_.robot_mode != RobotMode::power_off) return true;
  state_.robot_mode = RobotMode::power_on;
  state_.power_on = true;
  mode_until_ = now_ + nanoseconds(0.2 * config_.power_on_time);
  return true;
}

void Controller::power_off() {
  end_program("power off");
  finish_program();
  arm_.stop(config_.arm.protective_deceleration);
  state_.robot_mode = RobotMode::power_off;
  state_.power_on = false;
  release_when_idle_ = false;
}

bool Controller::brake_release() {
  if (!power_on()) return false;
  if (state_.robot_mode != RobotMode::running) release_when_idle_ = true;
  return true;
}

void Controller::advance_modes() {
  if (now_ < mode_until_) return;
  switch (state_.robot_mode) {
    case RobotMode::power_on:
      state_.robot_mode = RobotMode::booting;
      mode_until_ = now_ + nanoseconds(0.8 * config_.power_on_time);
      break;
    case RobotMode::booting:
      state_.robot_mode = RobotMode::idle;
      mode_until_ = now_ + nanoseconds(config_.brake_release_time);
      break;
    case RobotMode::idle:
      if (!release_when_idle_) {
        mode_until_ = now_ + nanoseconds(config_.brake_release_time);
        break;
      }
      release_when_idle_ = false;
      state_.robot_mode = RobotMode::running;
      break;
    default:
      break;
  }
}

void Controller::protective_stop(const std::string& why, std::int32_t code) {
  if (state_.safety_mode != SafetyMode::normal && state_.safety_mode != SafetyMode::reduced) return;
  state_.safety_mode = SafetyMode::protective_stop;
  protective_since_ = now_;
  ++counters_.protective_stops;
  popup_ = true;
  arm_.stop(config_.arm.protective_deceleration);
  if (phase_ == Phase::running) {
    state_.runtime_state = RuntimeState::paused;
    pause_requested_ = false;
  }
  say("Protective stop: " + why);
  Notice n{Notice::Kind::violation, "Protective stop: " + why, {}, 0, 0, code, 0};
  n.warning = code == by_program_code;
  tell(n);
}

void Controller::emergency_stop() {
  state_.safety_mode = SafetyMode::robot_emergency_stop;
  power_off();
  say("Robot emergency stop");
}

bool Controller::unlock_protective_stop() {
  if (state_.safety_mode != SafetyMode::protective_stop) return true;
  if (now_ - protective_since_ < nanoseconds(config_.unlock_time)) return false;
  state_.safety_mode = SafetyMode::normal;
  popup_ = false;
  return true;
}

void Controller::restart_safety() {
  power_off();
  state_.safety_mode = SafetyMode::normal;
}

// ---- inputs and the cycle
// ---------------------------------------------------------------------------------------

void Controller::inputs_written(const InputEffects& effects) {
  RobotInputs& in = state_.inputs;
  const auto masked = [&](std::uint8_t value, std::uint8_t mask, int shift) {
    const std::uint64_t m = std::uint64_t{mask} << shift;
    state_.digital_outputs = (state_.digital_outputs & ~m) | ((std::uint64_t{value} << shift) & m);
  };
  if (effects.standard) masked(in.standard_digital_output, in.standard_digital_output_mask, 0);
  if (effects.configurable) masked(in.configurable_digital_output, in.configurable_digital_output_mask, 8);
  if (effects.tool) masked(in.tool_digital_output, in.tool_digital_output_mask & 3, 16);
  if (effects.slider && in.speed_slider_mask == 1 && std::isfinite(in.speed_slider_fraction))
    scaling_ = std::clamp(in.speed_slider_fraction, 0.0, 1.0);
}

Joints Controller::load_at(const Links& links) const {
  // What hangs at the flange, less what the controller has been told of and holds.
  Joints load = torque_of_force(links, 5, links.flange.point(config_.arm.payload_centre),
                                {0, 0, -9.81 * config_.arm.unknown_payload});
  const Joints held =
      torque_of_force(links, 5, links.flange.point(state_.payload_cog), {0, 0, -9.81 * state_.payload});
  for (std::size_t i = 0; i < joint_count; ++i) load[i] += world_.load()[i] - held[i];
  return load;
}

void Controller::step() {
  advance_modes();
  if (unlocks_ && unlock_protective_stop()) unlocks_ = false;
  run_program();
  const Violation violation = arm_.plan(scaling_);
  if (violation != Violation::none) protective_stop(text_of(violation));

  const double h = seconds(plant_step);
  double largest = 0;
  if (finger_.pressing() && now_ - led_at_ > finger_waits) finger_.release();
  Joints load = load_at(forward_kinematics(arm_.q()));
  for (Nanoseconds t{}; t < cycle(); t += plant_step) {
    arm_.advance(load);
    now_ += plant_step;
    const Links links = forward_kinematics(arm_.q());
    if (scenario_runs_) {
      if (led_touch_) finger_.step(world_, *led_touch_, wish_, h);
      world_.advance(seconds(now_ - scenario_start_), h, links);
      largest = std::max(largest, world_.largest_force());
    }
    load = load_at(links);
    if (now_ >= next_skin_tick_) {
      next_skin_tick_ += config_.skin.period;
      const auto& samples = skin_.sample(now_, links, world_.stimulus());
      if (on_skin) on_skin(now_, samples);
    }
  }
  if (config_.protective_force > 0 && largest > config_.protective_force)
    protective_stop("contact force of " + std::to_string(static_cast<int>(largest)) + " N");
  arm_.measure();
  ++counters_.cycles;
  publish();
}

void check(const ForceSensorConfig& c) {
  using skinctl::require;
  const auto in = [](const char* what, const Vec3& v, double most, const char* range) {
    for (const double x : {v.x, v.y, v.z}) require(std::abs(x) <= most, what, x, range);
  };
  require(c.force_noise >= 0 && c.force_noise <= 100, "force noise", c.force_noise, "0 to 100 N");
  require(c.moment_noise >= 0 && c.moment_noise <= 10, "moment noise", c.moment_noise, "0 to 10 N m");
  require(c.bias_from >= 0 && c.bias_from <= 1e6, "bias from", c.bias_from, "0 to 1e6 s");
  in("force bias", c.force_bias, 1000, "-1000 to 1000 N");
  in("moment bias", c.moment_bias, 100, "-100 to 100 N m");
  in("force creep", c.force_creep, 100, "-100 to 100 N/s");
  in("moment creep", c.moment_creep, 10, "-10 to 10 N m/s");
  in("force per kelvin", c.force_per_kelvin, 10, "-10 to 10 N/K");
}

/// The wrench at the tool's point, along the axes of the base: of a CB3, which has no sensor, all that acts
/// on the arm; of an e-Series what acts beyond the flange and on link 5, less the payload that the controller
/// was told.
void Controller::publish_wrench(const Links& actual, Vec3 tool) {
  RobotState& s = state_;
  s.wrench_by_currents = six(world_.force(), world_.moment_about(tool));
  s.actual_tcp_force = s.raw_wrench = s.wrench_by_currents;
  s.tcp_force = norm(world_.force());
  if (config_.series != Series::e_series) return;
  const Pose& flange = actual.flange;
  const auto weight = [&](double mass, Vec3 centre) {
    const Vec3 force = flange.rotate_back({0, 0, -9.81 * mass});
    return FlangeWrench{force, cross(centre, force)};
  };
  const FlangeWrench carried = weight(config_.arm.unknown_payload, config_.arm.payload_centre),
                     told = weight(s.payload, s.payload_cog);
  const FlangeWrench raw = force_sensor_.read(
      {flange.rotate_back(world_.tool_force()) + carried.force,
       flange.rotate_back(world_.tool_moment_about(flange.origin)) + carried.moment},
      config_.force_sensor.bias_from > 0 ? scenario_time() : std::max(0.0, scenario_time()), arm_.warmer());
  s.raw_wrench = six(raw.force, raw.moment);
  const Vec3 force = flange.rotate(raw.force - told.force),
             moment = flange.rotate(raw.moment - told.moment) - cross(tool - flange.origin, force);
  s.actual_tcp_force = six(force, moment);
  s.tcp_force = norm(force);
}

void Controller::publish() {
  RobotState& s = state_;
  if (s.safety_mode != std::exchange(told_safety_mode_, s.safety_mode))
    tell({Notice::Kind::safety_mode, {}, {}, 0, 0, 0, static_cast<std::int32_t>(s.safety_mode)});
  s.timestamp = seconds(now_);
  s.control_step = counters_.cycles;
  s.target_q = arm_.target_q();
  s.target_dq = arm_.target_dq();
  s.target_ddq = arm_.target_ddq();
  s.actual_q = arm_.measured_q();
  s.actual_dq = arm_.measured_dq();
  const Links actual = forward_kinematics(s.actual_q), target = forward_kinematics(s.target_q);
  s.target_moment = gravity_torque(target);
  const Joints load = load_at(actual);
  for (std::size_t i = 0; i < joint_count; ++i) {
    s.target_current[i] = s.target_moment[i] / torque_constant[i];
    s.torque[i] = !s.power_on
                      ? 0
                      : arm_.motor_torque()[i] + arm_.torque_noise()[i] - (arm_.under_torque() ? 0 : load[i]);
    s.actual_current[i] = s.torque[i] / torque_constant[i];
    s.control_output[i] = s.power_on ? s.target_current[i] : 0;
    s.temperatures[i] = 28 + arm_.warmer();
    s.joint_voltage[i] = s.power_on ? 48 : 0;
  }
  const Pose offset = pose_of(s.tcp_offset), actual_tool = actual.flange * offset,
             target_tool = target.flange * offset;
  const Vec3 tool = actual_tool.origin;
  s.actual_tcp_pose = six_of(actual_tool);
  s.target_tcp_pose = six_of(target_tool);
  s.actual_tcp_speed =
      six(point_velocity(actual, 5, tool, s.actual_dq), angular_velocity(actual, 5, s.actual_dq));
  s.target_tcp_speed = six(point_velocity(target, 5, target_tool.origin, s.target_dq),
                           angular_velocity(target, 5, s.target_dq));
  publish_wrench(actual, tool);
  const Vec3 true_tool = forward_kinematics(arm_.q()).flange.origin;
  const double dt = seconds(cycle());
  const Vec3 acceleration =
      (1 / (dt * dt)) * (true_tool - 2 * tool_before_ + tool_before_that_) + Vec3{0, 0, 9.81};
  tool_before_that_ = tool_before_;
  tool_before_ = true_tool;
  s.tool_acceleration = actual.flange.rotate_back(acceleration);
  s.elbow_position = actual.link[2].origin;
  s.elbow_velocity = point_velocity(actual, 1, s.elbow_position, s.actual_dq);
  s.momentum = 18.4 * norm(Vec3{s.actual_tcp_speed[0], s.actual_tcp_speed[1], s.actual_tcp_speed[2]}) / 3;
  s.execution_time = 0.2;
  double deviation = 0;
  for (std::size_t i = 0; i < joint_count; ++i)
    deviation = std::max(deviation, std::abs(s.target_q[i] - s.actual_q[i]));
  s.position_deviation = std::min(1.0, deviation / stopping_deviation);
  s.collision = config_.protective_force > 0 ? std::min(1.0, s.tcp_force / config_.protective_force) : 0;
  if (arm_.under_torque() || s.control_mode == ControlMode::torque)
    s.control_mode = arm_.under_torque() ? ControlMode::torque : ControlMode::position;
  switch (s.robot_mode) {
    case RobotMode::running:
      s.joint_mode = 253;
      break;
    case RobotMode::idle:
      s.joint_mode = 255;
      break;
    case RobotMode::booting:
    case RobotMode::power_on:
      s.joint_mode = 247;
      break;
    default:
      s.joint_mode = 239;
      break;
  }
  s.program_running = phase_ != Phase::none && s.runtime_state != RuntimeState::stopped;
  s.target_speed_fraction = scaling_;
  s.speed_scaling = s.runtime_state == RuntimeState::playing ? scaling_ : 0;
}

}  // namespace simulated_ur5
