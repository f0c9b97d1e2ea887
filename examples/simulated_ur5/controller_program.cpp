// The controller's programs: loaded, started, interpreted, paused and ended.
#include <algorithm>

#include "examples/simulated_ur5/controller.hpp"

namespace simulated_ur5 {
namespace {

constexpr double pause_deceleration = 4, end_deceleration = 4;  // [rad/s^2]
/// What a socket brings as one command: eight integers.
constexpr std::size_t command_numbers = 8;

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
  start(std::move(code));
  return {};
}

void Controller::start(urscript::Code code) {
  program_name_ = code.name;
  ++counters_.programs;
  phase_ = Phase::running;
  watchdog_.reset();
  machine_.emplace(std::move(code));
  state_.runtime_state = RuntimeState::playing;
  pause_requested_ = false;
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
  return {arm_, state_, sockets_, watchdog_, line_, now_, cycle(), version(), on_notice, stop_for_safety_};
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
  const auto socket = machine_ ? machine_->reads_from(command_numbers, sockets_) : nullptr;
  return socket && socket->received.size() >= 4 * command_numbers;
}

bool Controller::awaits_command() const {
  return phase_ == Phase::running && state_.runtime_state == RuntimeState::playing &&
         machine_->reads_from(command_numbers, sockets_) != nullptr;
}

void Controller::end_program(const std::string& why) {
  if (phase_ == Phase::none || phase_ == Phase::stopping) return;
  say((program_name_.empty() ? "script" : program_name_) + ": " + why);
  arm_.stop(state_.safety_mode == SafetyMode::protective_stop ? config_.arm.protective_deceleration
                                                              : end_deceleration);
  phase_ = Phase::stopping;
  machine_.reset();
  sockets_.close_all();
  state_.control_mode = ControlMode::position;
  state_.runtime_state = RuntimeState::stopping;
}

void Controller::finish_program() {
  if (phase_ != Phase::none) tell_program("PROGRAM_XXX_STOPPED");
  phase_ = Phase::none;
  machine_.reset();
  sockets_.close_all();
  program_name_.clear();
  watchdog_.reset();
  state_.program_running = false;
  state_.runtime_state = RuntimeState::stopped;
}

const std::string& Controller::watched_input() const {
  static const std::string none;
  return watchdog_ ? watchdog_->variable : none;
}

void Controller::check_watchdog() {
  if (!watchdog_ || state_.runtime_state != RuntimeState::playing) return;
  if (phase_ != Phase::running) return;
  if (seconds(now_ - watchdog_fed_at_) * watchdog_->min_frequency <= 1) return;
  if (watchdog_->stops) {
    end_program("RTDE watchdog: " + watchdog_->variable + " was not written in time");
  } else {
    say("RTDE watchdog: " + watchdog_->variable + " was not written in time; paused");
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
  if (phase_ == Phase::running) {
    run_interpreted();
  } else if (phase_ == Phase::stopping && arm_.at_rest()) {
    finish_program();
  }
}

}  // namespace simulated_ur5
