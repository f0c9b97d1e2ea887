// What the main job is told: by options and by the scenario file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "skinctl/core/command.hpp"

namespace adapters::allegro {
class Palm;
}

namespace compliant_ur5 {

/// One number per joint, or per link; in a file one number stands for six.
using PerJoint = std::array<double, 6>;
constexpr PerJoint same(double x) {
  return {x, x, x, x, x, x};
}

/// What the arm feels touch by.
enum class Sense : unsigned char {
  skin,
  wrist,  ///< the force-torque sensor in the flange of an e-Series: what touches the tool
  motors  ///< their currents: what pushes any link harder than the gears rub
};
[[nodiscard]] constexpr const char* in_words(skinctl::Interface i) noexcept {
  return i == skinctl::Interface::position ? "position"
                                           : (i == skinctl::Interface::velocity ? "velocity" : "torque");
}
constexpr const char* in_words(Sense s) {
  return s == Sense::skin ? "skin" : s == Sense::wrist ? "wrist" : "motors";
}

/// One step of the task.
struct Goal {
  double at = 0;        ///< [s] after the first cycle
  PerJoint q{};         ///< [rad]
  double duration = 0;  ///< [s]; 0: as fast as `max_velocity` allows
};

/// How the arm behaves.
struct ControlSettings {
  double lambda = 12;  ///< tracking: `K_d = lambda M` [1/s]
  double K_c = 2;      ///< gain that brings it back to its task [1/s]
  double K_i1 = 0.2, K_i2 = 0.02;
  double decay = 4;                ///< friction of the virtual arm, in proportion to its mass [1/s]
  PerJoint viscous = same(1);      ///< and of each joint [N m s/rad]
  PerJoint force_gain = same(40);  ///< w_f of each link's skin [N per unit of the three force readings]
  double stiffest_wall = 3e3;      ///< under the skin's cover, that it may meet [N/m]
  double stiffest_hand = 1e4;      ///< likewise of a hand [N/m]
  double heaviest_hand = 10;       ///< [kg]
  double heavier_than_needed = 1;  ///< felt mass in units of the smallest one for which such contacts rest
  double force_threshold = 0.068;  ///< on the sum of the three force readings, above their rest level
  double force_limit = 65;         ///< on a body of `stiffest_wall` that a place meets, or it goes slower [N]
  double stopping = 3;             ///< deceleration of a place that is touched, along its normal [m/s^2]
  double skin_patience = 2;        ///< after so long without them the job ends [s]
  /// Without a skin: of each joint, as a tool on a long lever turns a flange that weighs next to nothing [kg
  /// m^2].
  PerJoint virtual_inertia = same(0.3);
  double max_velocity = 0.5;       ///< of motions to goals [rad/s]
  double velocity_limit = 3;       ///< of commands [rad/s]
  double acceleration_limit = 30;  ///< of commands [rad/s^2]
  double delay = 0.008;            ///< declared: of the robot [s]
  double lag = 0.008;              ///< declared: of the robot's drives [s]; servoj's lookahead comes on top
  /// By which the round trip to the robot's program may exceed that of the start [s]. It grows by whole
  /// cycles: by one of 8 ms a touch of 35 N becomes one of 37, by five one of 42, while nothing stops the
  /// arm.
  double delay_margin = 0.015;
  /// Without a state for so long the job ends [s]; until then the arm brakes and holds. TCP finds a packet
  /// that it has lost twice after 200 ms, thrice after 600.
  double state_patience = 0.5;
};

/// The same by torque, where the arm itself is the one that gives way.
struct TorqueControl {
  double lambda = 60;  ///< `K_d = lambda (M + motors)` [1/s]
  double K_c = 4;      ///< [1/s]
  PerJoint viscous =
      same(10);              ///< friction that the arm shows besides what its controller leaves [N m s/rad]
  PerJoint motor_inertia{};  ///< at the joints; those of a wrist outweigh its links [kg m^2]
  PerJoint viscous_scale{}, coulomb_scale{};  ///< shares of friction that the controller compensates
  double learning = 300;                      ///< of the friction that is left over [1/s^2]
  PerJoint most_friction{};                   ///< of what is learnt [N m]
  double dead_zone = 0.0009;                  ///< [rad]
  double patience = 0.04;  ///< after so long without a command the robot stops by itself [s]
  /// As `ControlSettings::delay_margin` [s]: states that come four at a time are no longer way, and the gains
  /// are allowed 13 ms of delay, of which a cycle and a half are declared.
  double delay_margin = 0.008;
};

/// How the arm gives way to its wrist sensor.
struct WristControl {
  double gain = 1;                ///< newtons that the arm gives way to per newton measured
  double threshold = 3;           ///< on |force|: less is no touch; 2/3 of it are subtracted [N]
  double moment_threshold = 0.3;  ///< likewise on |moment| about the middle of the flange [N m]
  double noise = 0.1;             ///< of the mean of 8 ms of a component, standard deviation [N]
  double moment_noise = 0.004;    ///< likewise [N m]
  double reach = 0.2;             ///< of the tool from the flange [m]
};

/// How it gives way to what its motors feel.
struct MotorControl {
  double gain = 1;              ///< N m that the arm gives way to per N m found
  double rate = 150;            ///< of the momentum observer [1/s]
  PerJoint damping = same(60);  ///< friction that the arm is felt to have: its filter is late [N m s/rad]
  double stiffest = 1000;       ///< of what it may meet, for the same reason [N/m]
  PerJoint threshold{9, 9, 6.5, 2.5, 2.5, 2.5};  ///< beyond dry friction and noise [N m]
  /// Of what is found, standard deviation [N m]: six times as much counts as life, so beyond dry friction
  /// that turns.
  PerJoint noise{1.1, 1.1, 0.8, 0.3, 0.3, 0.3};
  PerJoint rotor_inertia{0.5, 0.5, 0.5, 0.1, 0.1, 0.1};  ///< at the joints [kg m^2]
  PerJoint viscous{7, 7, 5, 1.5, 1.5, 1.5};              ///< friction of the gears [N m s/rad]
  PerJoint coulomb{6, 6, 4, 1.5, 1.5, 1.5};              ///< likewise, dry [N m]
  /// At the joint, of a controller that tells currents, no torques [N m/A].
  PerJoint torque_constant{12.5, 12.5, 12.5, 9, 9, 9};
};

/// What the arm keeps clear of, with `--clear`.
struct ClearSettings {
  double margin = 0.02;       ///< of surfaces: its links, base, table, and what cells see [m]
  double table = 0;           ///< height of the table, or the ground, above the base's origin [m]
  double tool_length = 0;     ///< of a tool at the flange [m]; 0: none
  double tool_radius = 0.05;  ///< likewise [m]
  double approach =
      0;  ///< speed with which what is seen may come nearer, for which the arm leaves room [m/s]
  /// w_p of a link as a share of its w_f: how hard it gives way to what it sees.
  double proximity_share = 0.5;
  double proximity_distance = 0.01;  ///< of a finger that a cell reads as 0.5, from the scenario's [skin] [m]
};

/// A hand at the flange.
struct CarriedHand {
  double mass = 0;                    ///< of all that hangs there [kg]
  std::array<double, 3> centre{};     ///< its centre of mass in the flange's frame [m]
  double palm_gain = 0;               ///< [N per unit of the three readings]; 0: its palm feels nothing
  std::array<double, 3> palm{};       ///< place of the palm's cell in link 5 [m]
  std::array<double, 9> palm_axes{};  ///< its axes x, y, z there; z is the outward normal
  adapters::allegro::Palm* reading = nullptr;  ///< lives as long as the run
};

struct Settings {
  std::string scenario;                    ///< TOML file
  std::optional<std::string> robot;        ///< host of a real robot; none: the simulated one
  std::string skin;                        ///< skin file; empty: the generated skin with the scenario's gains
  std::string simulated_skin;              ///< of the simulated robot, where it is not the one of `skin`
  std::string skin_address = "127.0.0.1";  ///< of this computer, where skin datagrams come in
  std::uint16_t skin_port = 0;             ///< likewise; 0: any
  std::string skin_sender;                 ///< the only address whose skin datagrams are taken; empty: any
  std::string skin_key;                    ///< file with the key of authenticated skin datagrams; empty: none
  std::uint64_t cycles = 0;                ///< 0: as long as the scenario lasts
  double rate = 125;
  std::string preset =
      "balanced";    ///< or "fast": `skinctl::preset`; here in double, as the robot's states are
  double speed = 0;  ///< of the simulation: 0: lock-step, 1: real time
  skinctl::Interface interface = skinctl::Interface::position;
  Sense sense = Sense::skin;
  std::string touch_profile;     ///< CSV that replaces the scenario's touches
  std::string skin_faults;       ///< of the simulated skin: see `simulated_ur5::read_skin_faults`
  bool trust_all_cells = false;  ///< readings count as they come
  bool rigid = false;            ///< the skin does not act
  bool keep_clear = false;       ///< of its own links, the table, and what its cells see
  bool compare = true;           ///< simulated: run the scenario rigid as well
  bool quiet = false;
  bool live = false;                         ///< a page shows the run while it runs
  bool until_stopped = false;                ///< no number of cycles; a simulated robot begins its task anew
  std::uint16_t live_port = 8765;            ///< of the page; 0: any
  bool allow_control = false;                ///< who sees the page may resume
  std::string record, replay, report, json;  ///< files; empty: none
  std::uint16_t rtde_port = 30004, script_port = 30002, dashboard_port = 29999, rest_port = 80;
  std::uint16_t reverse_port = 0;   ///< of this computer, where the robot's program connects; 0: any
  std::uint16_t told_port = 0;      ///< that the robot is told, where it is forwarded here; 0: the same
  bool unlock = false;              ///< a protective stop may be released while connecting
  double network_delay = -1;        ///< to the robot and back, beyond one cycle [s]; negative: measured
  double duration = 60;             ///< [s], from the scenario
  double newtons_per_reading = 20;  ///< of the skin, from the scenario's [skin]
  double rest_reading = 0.004;      ///< of each force sensor, likewise
  double force_delta =
      2.0 / 1024;  ///< smallest change of a reading that a cell sends, likewise; 0: all are sent
  ControlSettings control;
  TorqueControl torque;
  WristControl wrist;
  MotorControl motors;
  ClearSettings clear;
  std::optional<CarriedHand> hand;
  std::vector<Goal> task;
};

/// Reads the tables `[run]`, `[control]`, `[torque]`, `[wrist_control]`, `[motor_control]`, `[clear]`,
/// `[skin]` and `[[goal]]` of a scenario; others are the simulation's. Throws `skinctl::ConfigurationError`
/// with file and line for unknown keys of its own tables and wrong types.
void read_scenario(const std::string& file, Settings& settings);

}  // namespace compliant_ur5
