// The controller's programs: loaded, started, streamed, interpreted, paused and ended.
#include <algorithm>

#include "examples/simulated_ur5/controller.hpp"

namespace simulated_ur5 {
namespace {

constexpr std::size_t most_pending = 64;
constexpr double pause_deceleration = 4;

}  // namespace

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
    if (machine_) machine_->begin_anew();
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
  urscript::Code code;
  const urscript::Problem problem = urscript::compile(script, version(), code);
  const std::string name = code.name.empty() ? "script" : code.name;
  if (!problem.text.empty()) {
    tell_problem(problem);
    say(name + " refused: " + problem.text);
    return problem.text;
  }
  if (code.secondary) {
    run_secondary(std::move(code));
    return {};
  }
  std::string why;
  if (state_.robot_mode != RobotMode::running)
    why = "the robot is not running: power on and release the brakes first";
  else if (state_.safety_mode != SafetyMode::normal && state_.safety_mode != SafetyMode::reduced)
    why = "the robot is stopped for safety";
  if (!why.empty()) {
    say(name + " refused: " + why);
    return why;
  }
  if (phase_ != Phase::none) {
    end_program("replaced by " + name);
    finish_program();
  }
  start(recognise(script, seconds(cycle())), std::move(code));
  return {};
}

void Controller::start(Program program, urscript::Code code) {
  program_ = std::move(program);
  program_.name = code.name;
  ++counters_.programs;
  phase_ = program_.streams() ? Phase::connecting : Phase::interpreted;
  if (phase_ == Phase::interpreted) {
    program_.watchdog.reset();
    machine_.emplace(std::move(code));
  }
  state_.runtime_state = RuntimeState::playing;
  pause_requested_ = false;
  connected_ = peer_gone_ = first_message_ = joining_ = ends_after_stop_ = false;
  mode_ = -1;
  deadline_ = 0;
  pending_.clear();
  watchdog_fed_at_ = now_;
  state_.program_running = true;  // clients see it before the next cycle
  tell_program("PROGRAM_XXX_STARTED");
}

void Controller::tell_problem(const urscript::Problem& problem) {
  Notice n{Notice::Kind::exception, problem.text};
  n.line = problem.at.line;
  n.column = problem.at.column;
  tell(n);
}

urscript::Robot Controller::robot_of_program() {
  return {arm_, state_,  sockets_,  program_.watchdog, line_,
          now_, cycle(), version(), on_notice,         stop_for_safety_};
}

void Controller::run_secondary(urscript::Code code) {
  const std::string name = code.name;
  urscript::Machine machine(std::move(code));
  urscript::Robot robot = robot_of_program();
  machine.step(robot);
  for (const std::string& function : machine.skipped())
    say(name + ": " + function + ": secondary programs must not move or wait; skipped");
  if (!machine.problem().text.empty()) tell_problem(machine.problem());
}

void Controller::run_interpreted() {
  urscript::Robot robot = robot_of_program();
  machine_->step(robot);
  state_.script_line = static_cast<std::uint32_t>(machine_->line());
  if (!scenario_runs_ && arm_.streamed()) start_scenario();
  if (!machine_->ended()) return;
  const urscript::Problem problem = machine_->problem();
  if (!problem.text.empty()) tell_problem(problem);
  end_program(problem.text.empty() ? "finished"
                                   : "line " + std::to_string(problem.at.line) + ": " + problem.text);
}

bool Controller::has_command() const {
  if (phase_ != Phase::interpreted) return !pending_.empty();
  const auto socket = machine_->reads_from(8, sockets_);
  return socket && socket->received.size() >= reverse_message_size;
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
  if (phase_ == Phase::interpreted)
    return state_.runtime_state == RuntimeState::playing && machine_->reads_from(8, sockets_) != nullptr;
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
  machine_.reset();
  sockets_.close_all();
  state_.control_mode = ControlMode::position;
  pending_.clear();
  state_.runtime_state = RuntimeState::stopping;
}

void Controller::finish_program() {
  if (phase_ != Phase::none) tell_program("PROGRAM_XXX_STOPPED");
  phase_ = Phase::none;
  machine_.reset();
  sockets_.close_all();
  program_ = Program{};
  state_.program_running = false;
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

const std::string& Controller::watched_input() const {
  static const std::string none;
  return program_.watchdog ? program_.watchdog->variable : none;
}

void Controller::check_watchdog() {
  if (!program_.watchdog || state_.runtime_state != RuntimeState::playing) return;
  if (phase_ != Phase::streaming && phase_ != Phase::interpreted) return;
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
    case Phase::interpreted:
      run_interpreted();
      break;
    case Phase::stopping:
      if (arm_.at_rest()) finish_program();
      break;
    case Phase::connecting:
    case Phase::none:
      break;
  }
}

}  // namespace simulated_ur5
