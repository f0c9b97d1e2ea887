#include "examples/simulated_ur5/controller.hpp"

#include <algorithm>

#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

// Torque per current at the joint [N m/A]: of the order of what such gears and motors give; not the maker's
// numbers.
constexpr Joints torque_constant = {12.5, 12.5, 12.5, 9, 9, 9};
constexpr std::size_t most_pending = 64;
constexpr double pause_deceleration = 4;

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
  tell({Notice::Kind::key, program_.name.empty() ? "unnamed" : program_.name, event});
}

double Controller::scenario_time() const {
  return scenario_runs_ ? seconds(now_ - scenario_start_) : -1;
}

void Controller::start_scenario() {
  scenario_runs_ = true;
  scenario_start_ = now_;
  world_.restart();
  // From here on everything is a function of the seed and the commands, whenever the client came.
  arm_.reseed(config_.seed);
  skin_.restart(config_.seed + 1);
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
  if (phase_ == Phase::connecting || phase_ == Phase::streaming || phase_ == Phase::straight) {
    state_.runtime_state = RuntimeState::paused;
    pause_requested_ = false;
  }
  say("Protective stop: " + why);
  tell({Notice::Kind::violation, "Protective stop: " + why, {}, 0, 0, code, 0});
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

// ---- programs
// ---------------------------------------------------------------------------------------------------

void Controller::load(std::string name, std::string script) {
  loaded_name_ = std::move(name);
  loaded_script_ = std::move(script);
}

bool Controller::play() {
  if (state_.robot_mode != RobotMode::running || state_.safety_mode != SafetyMode::normal) return false;
  if (state_.runtime_state == RuntimeState::paused || state_.runtime_state == RuntimeState::pausing) {
    pause_requested_ = false;
    state_.runtime_state = RuntimeState::playing;
    deadline_ = 0;  // the read that was under way starts anew
    watchdog_fed_at_ = now_;
    return true;
  }
  if (phase_ == Phase::stopping) return false;
  if (phase_ != Phase::none) return true;
  return !loaded_script_.empty() && run(loaded_script_).empty();
}

bool Controller::pause() {
  if (state_.runtime_state != RuntimeState::playing) return false;
  state_.runtime_state = RuntimeState::pausing;
  pause_requested_ = true;
  return true;
}

bool Controller::stop_program() {
  if (phase_ == Phase::none) return true;
  end_program("stopped at the panel");
  return true;
}

std::string Controller::run(const std::string& script) {
  Program program = recognise(script, seconds(cycle()));
  const std::string name = program.name.empty() ? "script" : program.name;
  for (const std::string& w : program.warnings) say(name + ": " + w);
  if (!program.error.empty()) {
    say(name + " refused: " + program.error);
    return program.error;
  }
  if (program.secondary) {
    for (const Statement& s : program.statements) {
      const bool moves = s.kind == Statement::Kind::move || s.kind == Statement::Kind::speed ||
                         s.kind == Statement::Kind::stop || s.kind == Statement::Kind::sleep ||
                         s.kind == Statement::Kind::halt;
      if (moves) {
        say(name + ": secondary programs must not move or wait; skipped");
        continue;
      }
      run_statement(s);
    }
    return {};
  }
  if (state_.robot_mode != RobotMode::running) {
    const std::string why = "the robot is not running: power on and release the brakes first";
    say(name + " refused: " + why);
    return why;
  }
  if (state_.safety_mode != SafetyMode::normal && state_.safety_mode != SafetyMode::reduced) {
    const std::string why = "the robot is stopped for safety";
    say(name + " refused: " + why);
    return why;
  }
  if (phase_ != Phase::none) {
    end_program("replaced by " + name);
    finish_program();
  }
  program_ = std::move(program);
  ++counters_.programs;
  phase_ = program_.streams() ? Phase::connecting : Phase::straight;
  state_.runtime_state = RuntimeState::playing;
  pause_requested_ = false;
  connected_ = peer_gone_ = first_message_ = joining_ = ends_after_stop_ = false;
  mode_ = -1;
  deadline_ = 0;
  pending_.clear();
  next_statement_ = 0;
  waiting_ = false;
  watchdog_fed_at_ = now_;
  tell_program("PROGRAM_XXX_STARTED");
  return {};
}

const Program* Controller::wants_sockets() const {
  const bool open = (phase_ == Phase::connecting || phase_ == Phase::streaming) && !peer_gone_;
  return open ? &program_ : nullptr;
}

void Controller::sockets_opened() {
  if (phase_ == Phase::connecting) {
    phase_ = Phase::streaming;
    connected_ = true;
  }
}

void Controller::sockets_failed() {
  if (phase_ == Phase::connecting) end_program("cannot reach the address that the program opens");
}

void Controller::reverse_closed() {
  if (phase_ == Phase::streaming) peer_gone_ = true;
}

void Controller::reverse_message(const ReverseMessage& message) {
  if (phase_ != Phase::streaming) return;
  ++counters_.reverse_messages;
  if (pending_.size() == most_pending) pending_.pop_front();
  pending_.push_back(message);
}

bool Controller::awaits_command() const {
  const bool reads =
      phase_ == Phase::connecting || (phase_ == Phase::streaming && !(joining_ && ends_after_stop_));
  return reads && !peer_gone_ && state_.runtime_state == RuntimeState::playing;
}

void Controller::end_program(const std::string& why) {
  if (phase_ == Phase::none || phase_ == Phase::stopping) return;
  say((program_.name.empty() ? "script" : program_.name) + ": " + why);
  arm_.stop(state_.safety_mode == SafetyMode::protective_stop ? config_.arm.protective_deceleration
                                                              : program_.stop_deceleration);
  phase_ = Phase::stopping;
  pending_.clear();
  state_.runtime_state = RuntimeState::stopping;
}

void Controller::finish_program() {
  if (phase_ != Phase::none) tell_program("PROGRAM_XXX_STOPPED");
  phase_ = Phase::none;
  program_ = Program{};
  state_.runtime_state = RuntimeState::stopped;
}

void Controller::leave_motion(std::int32_t next_mode) {
  // The motion thread ends with a stopj, which the main thread waits for before it starts the next one.
  const bool moved = mode_ == 1 || mode_ == 2;
  if (moved && next_mode != mode_) {
    arm_.stop(program_.stop_deceleration);
    joining_ = true;
  }
}

void Controller::apply(const ReverseMessage& m) {
  Joints v{};
  for (std::size_t i = 0; i < joint_count; ++i) v[i] = m.values[i] / program_.multiplier;
  if (m.mode == 1) {
    arm_.servo(v, program_.servo_lookahead, program_.servo_gain);
  } else if (m.mode == 2) {
    arm_.speed(v, program_.speed_acceleration);
  } else if (m.mode != 0 && m.mode != mode_) {
    say("mode " + std::to_string(m.mode) + " of the reverse socket is not known here; the arm stands still");
  }
  mode_ = m.mode;
  if (!scenario_runs_ && (m.mode == 1 || m.mode == 2)) start_scenario();
}

void Controller::run_stream() {
  if (joining_) {
    if (!pending_.empty()) {
      latest_ = pending_.back();
      pending_.clear();
    }
    if (!arm_.at_rest()) return;
    joining_ = false;
    if (ends_after_stop_) {
      end_program("stopped by its commander");
      return;
    }
    deadline_ = latest_.read_timeout_ms > 0 ? now_ + Nanoseconds{latest_.read_timeout_ms} * 1'000'000 : 0;
    if (latest_.mode == -2)
      end_program("stopped by its commander");
    else
      apply(latest_);
    return;
  }
  if (pending_.empty()) {
    if (peer_gone_) {
      end_program("the reverse socket was closed");
      return;
    }
    if (first_message_) ++counters_.cycles_without_message;
    if (deadline_ > 0 && now_ >= deadline_) {
      ++counters_.read_timeouts;
      end_program("no command within the read timeout");
    }
    return;
  }
  while (!pending_.empty()) {
    latest_ = pending_.front();
    pending_.pop_front();
    first_message_ = true;
    if (latest_.mode != mode_) {
      leave_motion(latest_.mode);
      if (joining_) {
        ends_after_stop_ = latest_.mode == -2;
        return;
      }
    }
    if (latest_.mode == -2) {
      end_program("stopped by its commander");
      return;
    }
    apply(latest_);
  }
  deadline_ = latest_.read_timeout_ms > 0 ? now_ + Nanoseconds{latest_.read_timeout_ms} * 1'000'000 : 0;
}

bool Controller::run_statement(const Statement& s) {
  using Kind = Statement::Kind;
  switch (s.kind) {
    case Kind::stop:
      if (!waiting_) arm_.stop(s.number);
      return arm_.at_rest();
    case Kind::move:
      if (!waiting_) {
        if (!arm_.at_rest()) {
          arm_.stop(program_.stop_deceleration);
          next_statement_ -= 1;  // come back to it at rest
          wait_until_ = 0;
          return true;
        }
        arm_.move(s.joints, s.acceleration, s.velocity, s.duration);
        return false;
      }
      return !arm_.moving();
    case Kind::speed:
      if (!waiting_) {
        arm_.speed(s.joints, s.acceleration);
        wait_until_ = now_ + nanoseconds(std::clamp(s.duration, 0.0, 3600.0));
        return false;
      }
      return now_ >= wait_until_;
    case Kind::sleep:
      if (!waiting_) {
        wait_until_ = now_ + nanoseconds(s.number);
        return false;
      }
      return now_ >= wait_until_;
    case Kind::digital_output: {
      const std::uint64_t bit = std::uint64_t{1} << s.index;
      state_.digital_outputs = s.flag ? state_.digital_outputs | bit : state_.digital_outputs & ~bit;
      return true;
    }
    case Kind::text:
      say(s.text);
      tell({Notice::Kind::text, s.text});
      return true;
    case Kind::popup:
      popup_ = true;
      say("Popup: " + s.text);
      tell({Notice::Kind::popup, s.text});
      return true;
    case Kind::integer_register:
      state_.outputs.integers[s.index] =
          static_cast<std::int32_t>(std::clamp(s.number, -2147483648.0, 2147483647.0));
      return true;
    case Kind::double_register:
      state_.outputs.doubles[s.index] = s.number;
      return true;
    case Kind::bit_register:
      state_.outputs.bits[s.index] = s.flag;
      return true;
    case Kind::halt:
      next_statement_ = program_.statements.size();
      return true;
  }
  return true;
}

void Controller::run_straight() {
  // Statements that take no time run at once, up to a bound per cycle.
  for (int i = 0; i < 100; ++i) {
    if (next_statement_ >= program_.statements.size()) {
      end_program("finished");
      return;
    }
    const std::size_t at = next_statement_++;
    const bool done = run_statement(program_.statements[at]);
    if (!done) {
      waiting_ = true;
      next_statement_ = at;
      return;
    }
    waiting_ = false;
    if (next_statement_ == at) return;  // it wants to come back
  }
}

const std::string& Controller::watched_input() const {
  static const std::string none;
  return program_.watchdog ? program_.watchdog->variable : none;
}

void Controller::check_watchdog() {
  if (!program_.watchdog || state_.runtime_state != RuntimeState::playing) return;
  if (phase_ != Phase::streaming && phase_ != Phase::straight) return;
  if (seconds(now_ - watchdog_fed_at_) * program_.watchdog->min_frequency <= 1) return;
  if (program_.watchdog->stops) {
    end_program("RTDE watchdog: " + program_.watchdog->variable + " was not written in time");
  } else {
    say("RTDE watchdog: " + program_.watchdog->variable + " was not written in time; paused");
    pause();
  }
}

void Controller::run_program() {
  if (state_.runtime_state == RuntimeState::pausing) {
    if (pause_requested_) {
      arm_.stop(pause_deceleration);
      pause_requested_ = false;
      waiting_ = false;
    }
    if (arm_.at_rest()) state_.runtime_state = RuntimeState::paused;
    return;
  }
  if (state_.runtime_state == RuntimeState::paused) return;
  check_watchdog();
  switch (phase_) {
    case Phase::streaming:
      run_stream();
      break;
    case Phase::straight:
      run_straight();
      break;
    case Phase::stopping:
      if (arm_.at_rest()) finish_program();
      break;
    case Phase::connecting:
    case Phase::none:
      break;
  }
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
  const double weight = 9.81 * config_.arm.unknown_payload;
  Joints load = torque_of_force(links, 5, links.flange.origin, {0, 0, -weight});
  for (std::size_t i = 0; i < joint_count; ++i) load[i] += world_.load()[i];
  return load;
}

void Controller::step() {
  advance_modes();
  run_program();
  const Violation violation = arm_.plan(scaling_);
  if (violation != Violation::none) protective_stop(text_of(violation));

  const double h = seconds(plant_step);
  double largest = 0;
  Joints load = load_at(forward_kinematics(arm_.q()));
  for (Nanoseconds t{}; t < cycle(); t += plant_step) {
    arm_.advance(load);
    now_ += plant_step;
    const Links links = forward_kinematics(arm_.q());
    if (scenario_runs_) {
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

void Controller::publish() {
  RobotState& s = state_;
  s.timestamp = seconds(now_);
  s.target_q = arm_.target_q();
  s.target_dq = arm_.target_dq();
  s.target_ddq = arm_.target_ddq();
  s.actual_q = arm_.measured_q();
  s.actual_dq = arm_.measured_dq();
  const Links actual = forward_kinematics(s.actual_q), target = forward_kinematics(s.target_q);
  const Joints held = gravity_torque(actual);
  s.target_moment = gravity_torque(target);
  const Joints load = load_at(actual);
  for (std::size_t i = 0; i < joint_count; ++i) {
    s.target_current[i] = s.target_moment[i] / torque_constant[i];
    s.actual_current[i] = s.power_on ? (held[i] - load[i]) / torque_constant[i] : 0;
    s.control_output[i] = s.power_on ? s.target_current[i] : 0;
    s.temperatures[i] = 28;
    s.joint_voltage[i] = s.power_on ? 48 : 0;
  }
  const Vec3 tool = actual.flange.origin;
  s.actual_tcp_pose = six(tool, rotation_vector(actual.flange));
  s.target_tcp_pose = six(target.flange.origin, rotation_vector(target.flange));
  s.actual_tcp_speed =
      six(point_velocity(actual, 5, tool, s.actual_dq), angular_velocity(actual, 5, s.actual_dq));
  s.target_tcp_speed = six(point_velocity(target, 5, target.flange.origin, s.target_dq),
                           angular_velocity(target, 5, s.target_dq));
  const Vec3 force = world_.force();
  s.actual_tcp_force = six(force, world_.moment_about(tool));
  s.tcp_force = norm(force);
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
