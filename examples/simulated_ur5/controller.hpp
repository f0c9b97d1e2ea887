// The robot controller without sockets: modes, programs, inputs and outputs around the arm, its skin and the
// world.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "examples/simulated_ur5/contact.hpp"
#include "examples/simulated_ur5/force_sensor.hpp"
#include "examples/simulated_ur5/led_finger.hpp"
#include "examples/simulated_ur5/notice.hpp"
#include "examples/simulated_ur5/skin.hpp"
#include "examples/simulated_ur5/state.hpp"
#include "examples/simulated_ur5/urscript/machine.hpp"
#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5 {

constexpr Nanoseconds cycle_of(Series series) {
  return series == Series::cb3 ? 8'000'000 : 2'000'000;
}

struct ControllerConfig {
  Series series = Series::cb3;
  std::optional<Version> version;  ///< nothing: that of the series
  ArmConfig arm;
  SkinConfig skin;
  ForceSensorConfig force_sensor;  ///< of an e-Series; a CB3 reckons by its currents, here without fault
  std::vector<SkinCell> cells;
  std::vector<Touch> touches;
  std::uint64_t seed = 1;
  /// Contact force of one finger that makes a protective stop [N]; 0: never.
  double protective_force = 150;
  /// True: the arm stands powered, brakes released. False: as after switching on, waiting for `power on`.
  bool powered = false;
  /// True: the touches' clock starts with the controller. False: with the first motion command of the first
  /// stream.
  bool scenario_at_boot = false;
  double power_on_time = 1.0;       ///< from power off to idle [s]
  double brake_release_time = 0.5;  ///< from idle to running [s]
  double unlock_time = 5;           ///< a protective stop cannot be unlocked earlier [s]
};
void check(const ControllerConfig& config);

/// Counters that tests and reports look at.
struct Counters {
  std::uint64_t cycles = 0;
  std::uint64_t protective_stops = 0;
  std::uint64_t programs = 0;
};

/// One UR5 with its controller; deterministic: the same calls give the same states.
class Controller {
 public:
  explicit Controller(ControllerConfig config);

  /// One control cycle: runs the program, moves arm and fingers, samples the skin.
  void step();

  Nanoseconds now() const { return now_; }
  Nanoseconds cycle() const { return cycle_of(config_.series); }
  const RobotState& state() const { return state_; }
  const Arm& arm() const { return arm_; }
  const ContactWorld& world() const { return world_; }
  const Counters& counters() const { return counters_; }
  const ControllerConfig& config() const { return config_; }
  Version version() const { return config_.version.value_or(version_of(config_.series)); }
  Skin& skin() { return skin_; }
  /// The finger of the first touch that is `led` comes to a place of `link` (its frame), once the scenario
  /// runs; without such a touch nothing happens. It leaves when nobody has said for 0.5 s how it is led.
  void press(std::size_t link, Vec3 point, Vec3 normal);
  void lead_finger(const LedFinger::Wish& wish);
  void release_finger() { finger_.release(); }
  bool finger_presses() const { return finger_.pressing(); }
  /// On that finger [N].
  double finger_force() const { return led_touch_ ? world_.force_on(*led_touch_) : 0; }
  /// Seconds since the scenario's start, or -1.
  double scenario_time() const;

  /// Called with each skin tick's samples during `step`.
  std::function<void(Nanoseconds, const std::vector<SkinSample>&)> on_skin;
  /// Called with what the controller logs.
  std::function<void(const std::string&)> on_message;
  /// Called with what primary clients are told.
  std::function<void(const Notice&)> on_notice;

  // The panel: each returns false when the robot is in no state for it.
  bool power_on();
  void power_off();
  bool brake_release();
  bool play();
  bool pause();
  bool stop_program();
  /// False within `unlock_time` after the stop.
  bool unlock_protective_stop();
  /// The same as soon as it is allowed.
  void unlock_when_allowed() { unlocks_ = true; }
  void restart_safety();
  /// @param code  that primary clients are told: C<code>.
  void protective_stop(const std::string& why, std::int32_t code = path_code);
  void emergency_stop();
  void load(std::string name, std::string script);
  const std::string& loaded_name() const { return loaded_name_; }
  bool popup() const { return popup_; }
  void close_popup() { popup_ = false; }
  void show_popup() { popup_ = true; }

  // Programs.
  /// Starts an uploaded program; a main program replaces the one that runs. Empty, or why it does not run.
  std::string run(const std::string& script);
  /// True while a program waits for eight integers from a socket, which are a command, and is not paused.
  bool awaits_command() const;
  /// True if a message has come that the next `step` will take.
  bool has_command() const;
  /// The sockets of the program.
  urscript::Sockets& sockets() { return sockets_; }
  /// A global variable of the program, as text; empty: there is none.
  std::string variable(std::string_view name) const {
    return machine_ ? machine_->variable(name) : std::string();
  }

  // Inputs from RTDE.
  RobotInputs& inputs() { return state_.inputs; }
  /// To be called after a client wrote inputs. `effects`: which of them have one. `keys`: all that were
  /// written.
  struct InputEffects {
    bool slider = false, standard = false, configurable = false, tool = false;
  };
  void inputs_written(const InputEffects& effects);
  /// A client wrote the watched input.
  void watchdog_fed() { watchdog_fed_at_ = now_; }
  /// Name of the input that a program watches, or empty.
  const std::string& watched_input() const;

 private:
  enum class Phase { none, running, stopping };
  void say(const std::string& text);
  void tell(const Notice& notice);
  void tell_program(const char* event);
  void end_program(const std::string& why);
  void finish_program();
  void run_program();
  void run_interpreted();
  void run_secondary(urscript::Code code);
  void start(urscript::Code code);
  void tell_problem(const urscript::Problem& problem);
  urscript::Robot robot_of_program();
  void check_watchdog();
  void advance_modes();
  void start_scenario();
  void publish();
  void publish_wrench(const Links& actual, Vec3 tool);
  /// Torque on the joints [N m]: contacts, and the weight that the controller does not know of.
  Joints load_at(const Links& links) const;

  ControllerConfig config_;
  Arm arm_;
  Skin skin_;
  ForceSensor force_sensor_;
  ContactWorld world_;
  RobotState state_;
  Counters counters_;
  Nanoseconds now_{};

  // Power and safety.
  Nanoseconds mode_until_{};
  bool release_when_idle_ = false;
  Nanoseconds protective_since_{};
  bool popup_ = false;

  // Program.
  Phase phase_ = Phase::none;
  std::string program_name_;
  std::optional<urscript::Watchdog> watchdog_;
  std::string loaded_name_, loaded_script_;
  bool pause_requested_ = false;
  double scaling_ = 1;
  std::optional<urscript::Machine> machine_;
  urscript::Sockets sockets_;
  urscript::Line line_;
  std::function<void(const std::string&, std::int32_t)> stop_for_safety_;
  bool unlocks_ = false;                              ///< a protective stop, as soon as it is allowed
  SafetyMode told_safety_mode_ = SafetyMode::normal;  ///< to primary clients
  Nanoseconds watchdog_fed_at_{};

  // Scenario.
  bool scenario_runs_ = false;
  Nanoseconds scenario_start_{};
  Nanoseconds next_skin_tick_{};
  Vec3 tool_before_, tool_before_that_;

  // The finger that somebody leads.
  std::optional<std::size_t> led_touch_;
  LedFinger finger_;
  LedFinger::Wish wish_;
  Nanoseconds led_at_{};
};

}  // namespace simulated_ur5
